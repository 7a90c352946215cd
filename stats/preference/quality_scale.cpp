#include "stats/preference/quality_scale.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "stats/inference/distributions.hpp"
#include "stats/preference/scale_likelihood.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Numbers = std::vector<double>;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void check_scale_data(const ScaleData& data, double confidence) {
  const auto outside = [&](int condition) { return condition < 0 || condition >= data.conditions; };
  const auto count = [](double n) { return n >= 0 && std::isfinite(n); };
  bool sound = confidence > 0 && confidence < 1;
  for (const PairCount& one : data.pairs)
    sound = sound && !outside(one.first) && !outside(one.second) && one.first != one.second &&
            count(one.first_chosen) && count(one.second_chosen);
  for (const RatingCount& one : data.ratings) sound = sound && !outside(one.condition) && count(one.count);
  if (!sound)
    throw std::invalid_argument(
        "quality_scale: a condition is outside the list or paired with itself, a count is negative or not "
        "finite, or the confidence is not between 0 and 1; mend the data");
}

/// The answers of each person, in order of first appearance.
std::vector<std::pair<int, ScaleAnswers>> by_person(const ScaleData& data) {
  std::vector<std::pair<int, ScaleAnswers>> out;
  std::map<int, std::size_t> places;
  const auto of = [&](int person) -> ScaleAnswers& {
    const auto [place, fresh] = places.try_emplace(person, out.size());
    if (fresh) out.emplace_back(person, ScaleAnswers{});
    return out[place->second].second;
  };
  for (const PairCount& one : data.pairs)
    if (one.first_chosen + one.second_chosen > 0) of(one.person).pairs.push_back(one);
  for (const RatingCount& one : data.ratings)
    if (one.count > 0) of(one.person).ratings.push_back(one);
  return out;
}

/// Linear combinations of the parameters: the values of conditions with sum 0, then w and k if they are
/// fitted.
struct Combinations {
  const ScaleLayout& layout;

  std::size_t size() const {
    return index(layout.conditions) + (layout.order ? 1 : 0) + (layout.levels.empty() ? 0 : 1);
  }
  Numbers of(std::span<const double> x) const {
    Numbers out(index(layout.conditions));
    double mean = 0;
    for (int i = 0; i < layout.conditions; ++i) mean += ScaleLayout::value(x, i) / layout.conditions;
    for (int i = 0; i < layout.conditions; ++i) out[index(i)] = ScaleLayout::value(x, i) - mean;
    if (layout.order) out.push_back(x[layout.order_place()]);
    if (!layout.levels.empty()) out.push_back(x[layout.slope_place()]);
    return out;
  }
  /// L C L^T of a covariance C of the parameters.
  Numbers covariance(std::span<const double> of_parameters) const {
    const std::size_t n = size(), k = layout.size();
    Numbers half, out(n * n);  // half: rows of C, each combined
    for (std::size_t r = 0; r < k; ++r) {
      const Numbers row = of(of_parameters.subspan(r * k, k));
      half.insert(half.end(), row.begin(), row.end());
    }
    Numbers column(k);
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t r = 0; r < k; ++r) column[r] = half[r * n + c];
      const Numbers combined = of(column);
      for (std::size_t r = 0; r < n; ++r) out[r * n + c] = combined[r];
    }
    return out;
  }
};

Numbers roots_of_diagonal(const Numbers& matrix, std::size_t n) {
  Numbers out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = std::sqrt(std::max(0.0, matrix[i * n + i]));
  return out;
}

double choices_of(const ScaleAnswers& answers) {
  double sum = 0;
  for (const PairCount& one : answers.pairs) sum += one.first_chosen + one.second_chosen;
  return sum;
}

double ratings_of(const ScaleAnswers& answers) {
  double sum = 0;
  for (const RatingCount& one : answers.ratings) sum += one.count;
  return sum;
}

/// Log of the number of orders in which one person's choices can give its counts, summed over unordered
/// pairs.
double log_orders(const ScaleAnswers& answers) {
  std::map<std::pair<int, int>, std::pair<double, double>> pairs;
  for (const PairCount& one : answers.pairs) {
    auto& [low, high] = pairs[std::minmax(one.first, one.second)];
    (one.first < one.second ? low : high) += one.first_chosen;
    (one.first < one.second ? high : low) += one.second_chosen;
  }
  double sum = 0;
  for (const auto& [pair, n] : pairs)
    sum += std::lgamma(n.first + n.second + 1) - std::lgamma(n.first + 1) - std::lgamma(n.second + 1);
  return sum;
}

/// Quantile of Hazen (type 5).
double hazen(const Numbers& ascending, double p) {
  const auto n = static_cast<double>(ascending.size());
  const double place = std::clamp(p * n - 0.5, 0.0, n - 1);
  const auto low = static_cast<std::size_t>(place);
  const std::size_t high = std::min(low + 1, ascending.size() - 1);
  return ascending[low] + (place - static_cast<double>(low)) * (ascending[high] - ascending[low]);
}

/// Distances below the lower quartile in interquartile ranges; 0 above it.
Numbers quartile_scores(const Numbers& values) {
  Numbers ascending = values, out;
  std::sort(ascending.begin(), ascending.end());
  const double low = hazen(ascending, 0.25), range = hazen(ascending, 0.75) - low;
  for (const double v : values) out.push_back(v < low && range > 0 ? (low - v) / range : 0);
  return out;
}

/// Covariance of the combinations by the sandwich: people's scores between two inverse informations.
Numbers sandwich(const ScaleMaximum& fit, const std::vector<std::pair<int, ScaleAnswers>>& people) {
  const std::size_t k = fit.layout.size();
  const auto n = static_cast<double>(people.size());
  Numbers covariance(k * k, 0.0);
  for (const auto& [person, answers] : people) {
    Numbers score(k, 0.0), step(k, 0.0);
    scale_log_likelihood(answers, fit.layout, fit.x, score);
    for (std::size_t r = 0; r < k; ++r)
      for (std::size_t c = 0; c < k; ++c) step[r] += fit.inverse[r * k + c] * score[c];
    for (std::size_t r = 0; r < k; ++r)
      for (std::size_t c = 0; c < k; ++c) covariance[r * k + c] += step[r] * step[c] * n / (n - 1);
  }
  return covariance;
}

void set_differences(QualityScale& out, const Numbers* covariance, std::size_t width, double quantile) {
  const auto conditions = static_cast<int>(out.jod.size());
  for (int i = 0; i < conditions; ++i) {
    for (int j = i + 1; j < conditions; ++j) {
      ScaleDifference one{.i = i, .j = j};
      one.jod = out.jod[index(i)] - out.jod[index(j)];
      one.probability = normal_probability(one.jod / jod_sigma);
      if (covariance) {
        const auto& c = *covariance;
        const std::size_t a = index(i), b = index(j);
        one.se = std::sqrt(std::max(0.0, c[a * width + a] + c[b * width + b] - 2 * c[a * width + b]));
        one.ci = {one.jod - quantile * *one.se, one.jod + quantile * *one.se};
        if (*one.se > 0) one.p = student_p(one.jod / *one.se, out.people - 1, Alternative::TwoSided);
      }
      out.differences.push_back(one);
    }
  }
}

/// Intervals and observers, from the fits without each person. Returns why there are none; empty if there
/// are.
std::string set_people_errors(QualityScale& out, const ScaleData& data, const ScaleOptions& options,
                              const ScaleMaximum& fit, const Combinations& combinations) {
  const auto people = by_person(data);
  out.people = static_cast<int>(people.size());
  if (people.size() < 3)
    return out.people == 1 ? "one person answered: many answers of one person say nothing of other people"
                           : "two people are too few for intervals over people";
  const std::size_t width = combinations.size();
  const auto n = static_cast<double>(people.size());
  std::vector<Numbers> without;
  Numbers mean(width, 0.0);
  std::vector<ScaleObserver> observers;
  for (const auto& [person, answers] : people) {
    const auto others = maximise_scale(data, options, &person, &fit);
    if (!others) {
      out.without = person;
      return others.reason();
    }
    without.push_back(Combinations{others->layout}.of(others->x));
    for (std::size_t i = 0; i < width; ++i) mean[i] += without.back()[i] / n;
    Numbers unused(others->x.size(), 0.0);
    ScaleObserver one{.person = person, .answers = choices_of(answers) + ratings_of(answers)};
    one.log_probability = scale_log_likelihood(answers, others->layout, others->x, unused);
    one.log_likelihood = one.log_probability + log_orders(answers);
    observers.push_back(one);
  }
  Numbers covariance(width * width, 0.0);
  for (const Numbers& one : without)
    for (std::size_t r = 0; r < width; ++r)
      for (std::size_t c = 0; c < width; ++c)
        covariance[r * width + c] += (one[r] - mean[r]) * (one[c] - mean[c]) * (n - 1) / n;
  const Numbers se = roots_of_diagonal(covariance, width);
  for (std::size_t i = 0; i < out.jod.size(); ++i)
    if (!(se[i] * se[i] > 1e-10 * out.model_covariance[i * out.jod.size() + i]))
      return "all people answered alike, so that their answers show no spread";

  const double quantile = student_upper_quantile(0.5 - options.confidence / 2, n - 1);
  const Numbers robust = roots_of_diagonal(combinations.covariance(sandwich(fit, people)), width);
  out.se.assign(se.begin(), se.begin() + static_cast<std::ptrdiff_t>(out.jod.size()));
  out.se_sandwich.assign(robust.begin(), robust.begin() + static_cast<std::ptrdiff_t>(out.jod.size()));
  for (std::size_t i = 0; i < out.jod.size(); ++i)
    out.ci.push_back({out.jod[i] - quantile * se[i], out.jod[i] + quantile * se[i]});
  if (out.order_bias) out.order_bias_se = se[out.jod.size()];
  if (out.slope) out.slope_se = se[width - 1];
  set_differences(out, &covariance, width, quantile);
  score_observers(observers);
  out.observers = std::move(observers);
  return {};
}

}  // namespace

void score_observers(std::vector<ScaleObserver>& observers) {
  if (observers.empty()) return;
  Numbers sums, means;
  for (const ScaleObserver& one : observers) {
    sums.push_back(one.log_likelihood);
    means.push_back(one.log_probability / one.answers);
  }
  const Numbers by_sum = quartile_scores(sums), by_mean = quartile_scores(means);
  for (std::size_t i = 0; i < observers.size(); ++i) {
    observers[i].score = by_sum[i];
    observers[i].score_per_answer = by_mean[i];
  }
}

std::vector<std::vector<int>> linked_groups(const ScaleData& data) {
  check_scale_data(data, 0.5);
  return answer_groups(summed_answers(data, nullptr), data.conditions, true);
}

Result<QualityScale> quality_scale(const ScaleData& data, const ScaleOptions& options) {
  check_scale_data(data, options.confidence);
  const auto fit = maximise_scale(data, options, nullptr, nullptr);
  if (!fit) return Refusal{fit.reason()};
  const ScaleLayout& layout = fit->layout;
  const Combinations combinations{layout};
  QualityScale out;
  out.jod = fit->jod();
  if (layout.order) out.order_bias = fit->x[layout.order_place()];
  if (!layout.levels.empty()) {
    out.slope = fit->x[layout.slope_place()];
    out.levels = layout.levels;
    out.thresholds.assign(fit->x.begin() + static_cast<std::ptrdiff_t>(layout.slope_place()) + 1,
                          fit->x.end());
    // Thresholds are of a scale with sum 0.
    const double shift = *out.slope * out.jod.front();
    for (double& threshold : out.thresholds) threshold += shift;
  }
  out.log_likelihood = fit->log_likelihood;
  out.choices = choices_of(fit->answers);
  out.ratings = ratings_of(fit->answers);
  const Numbers all = combinations.covariance(fit->inverse);
  const std::size_t n = out.jod.size(), width = combinations.size();
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t c = 0; c < n; ++c) out.model_covariance.push_back(all[r * width + c]);
  out.why_no_intervals = data.people_known ? set_people_errors(out, data, options, *fit, combinations)
                                           : "the data do not say which answers are of one person";
  if (!out.why_no_intervals.empty()) set_differences(out, nullptr, width, 0);
  return out;
}

}  // namespace stats
