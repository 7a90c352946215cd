#include "stats/preference/scale_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Vector = std::vector<double>;

constexpr double infinite = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The numbers of answers to the unordered pairs whose answers are unanimous.
Vector unanimous_pairs(const ScaleAnswers& answers) {
  std::map<std::pair<int, int>, std::pair<double, double>> wins;
  for (const PairCount& pair : answers.pairs) {
    const bool swap = pair.first > pair.second;
    auto& [low, high] = wins[std::minmax(pair.first, pair.second)];
    low += swap ? pair.second_chosen : pair.first_chosen;
    high += swap ? pair.first_chosen : pair.second_chosen;
  }
  Vector out;
  for (const auto& [pair, counts] : wins)
    if ((counts.first == 0) != (counts.second == 0)) out.push_back(counts.first + counts.second);
  return out;
}

/// Log of the prior; adds its gradient.
double log_prior(ScalePrior prior, const Vector& unanimous, const ScaleLayout& layout,
                 std::span<const double> x, std::span<double> gradient) {
  if (prior == ScalePrior::None) return 0;
  const int conditions = layout.conditions;
  Vector q(at(conditions));
  for (int i = 0; i < conditions; ++i) q[at(i)] = ScaleLayout::value(x, i);
  if (prior == ScalePrior::Normal) {
    const double mean = std::accumulate(q.begin(), q.end(), 0.0) / conditions;
    constexpr double variance = prior_sd_jod * prior_sd_jod;
    double sum = 0;
    for (int i = 0; i < conditions; ++i) {
      sum -= (q[at(i)] - mean) * (q[at(i)] - mean) / (2 * variance);
      ScaleLayout::add(gradient, i, -(q[at(i)] - mean) / variance);
    }
    if (layout.levels.empty()) return sum;
    constexpr double slope_variance = prior_sd_slope * prior_sd_slope;
    const double k = x[layout.slope_place()];
    gradient[layout.slope_place()] -= k / slope_variance;
    sum -= k * k / (2 * slope_variance);
    return sum;
  }
  const auto [low, high] = std::minmax_element(q.begin(), q.end());
  const double r = 1 + *high - *low;
  double sum = 0, slope = 0;
  for (const double n : unanimous) {
    const double loser = 1 / r + 0.1, winner = std::max(0.0, 1 / r - n / (r * r)) + 0.1;
    sum += (std::log(loser) + std::log(winner)) / 2;
    slope -= 1 / (r * r) / loser / 2;
    if (r > n) slope += (-1 / (r * r) + 2 * n / (r * r * r)) / winner / 2;
  }
  ScaleLayout::add(gradient, static_cast<int>(high - q.begin()), slope);
  ScaleLayout::add(gradient, static_cast<int>(low - q.begin()), -slope);
  return sum;
}

/// Who wins against whom. A condition with a rating above a rating of another counts as a winner over it: the
/// maximum is finite only if no set of conditions is above all others in choices and in ratings.
Vector wins_of(const ScaleAnswers& answers, int conditions) {
  Vector wins(at(conditions) * at(conditions), 0.0);
  const auto win = [&](int a, int b, double n) { wins[at(a) * at(conditions) + at(b)] += n; };
  for (const PairCount& pair : answers.pairs) {
    win(pair.first, pair.second, pair.first_chosen);
    win(pair.second, pair.first, pair.second_chosen);
  }
  std::map<int, std::pair<int, int>> range;  // lowest and highest rating
  for (const RatingCount& one : answers.ratings) {
    auto& [low, high] = range.try_emplace(one.condition, one.score, one.score).first->second;
    low = std::min(low, one.score);
    high = std::max(high, one.score);
  }
  for (const auto& [a, ratings_a] : range)
    for (const auto& [b, ratings_b] : range)
      if (a != b && ratings_a.second > ratings_b.first) win(a, b, 1);
  return wins;
}

/// True if the conditions can be given values so that in every pair shown the first condition has 1 more than
/// the second. These values and a bias towards the condition shown first then predict the same choices, and
/// no answers tell them apart.
bool orders_stand_for_values(const ScaleAnswers& answers, int conditions) {
  std::vector<std::optional<int>> value(at(conditions));
  for (int start = 0; start < conditions; ++start) {
    if (value[at(start)]) continue;
    value[at(start)] = 0;
    for (bool grown = true; grown;) {
      grown = false;
      for (const PairCount& pair : answers.pairs) {
        auto& first = value[at(pair.first)];
        auto& second = value[at(pair.second)];
        if (first && second && *first != *second + 1) return false;
        if (first.has_value() == second.has_value()) continue;
        grown = true;
        (first ? second : first) = first ? *first - 1 : *second + 1;
      }
    }
  }
  return true;
}

/// Why the answers do not determine one finite scale; empty if they do.
std::string undetermined(const ScaleAnswers& answers, const ScaleData& data, const ScaleOptions& options) {
  if (data.conditions < 2) return "fewer than two conditions";
  if (answers.pairs.empty()) return "no choice between two conditions: ratings alone have no scale in JOD";
  const auto groups = answer_groups(answers, data.conditions, true);
  if (groups.size() > 1) return std::to_string(groups.size()) + " groups of conditions that no answer links";
  if (!answers.ratings.empty()) {
    const auto linked = answer_groups(answers, data.conditions, false);
    const bool any = std::any_of(linked.begin(), linked.end(), [&](const std::vector<int>& group) {
      std::set<int> rated;
      for (const RatingCount& one : answers.ratings)
        if (std::find(group.begin(), group.end(), one.condition) != group.end()) rated.insert(one.condition);
      return rated.size() > 1;
    });
    if (!any) return no_common_unit;
    const bool varied = std::any_of(answers.ratings.begin(), answers.ratings.end(), [&](const auto& one) {
      return one.score != answers.ratings.front().score;
    });
    if (!varied) return "all ratings are equal";
  }
  if (options.order_bias && answers.ratings.empty() && orders_stand_for_values(answers, data.conditions))
    return no_order_bias;
  if (options.prior == ScalePrior::Normal) return {};
  return connection(wins_of(answers, data.conditions), data.conditions).reason;
}

/// Why the maximum is none; empty if it is one.
std::string unbounded(const Minimum& found, const ScaleLayout& layout) {
  constexpr double farthest = 50;
  if (!layout.levels.empty() && std::abs(found.x[layout.slope_place()]) > farthest)
    return "ratings tell conditions apart that choices do not, so that the two have no common unit";
  if (layout.order && (!found.converged || std::abs(found.x[layout.order_place()]) > farthest))
    return no_order_bias;
  if (found.converged) return "";
  return layout.levels.empty() ? "the fit did not converge"
                               : "the fit did not converge; choices and ratings may have no common unit";
}

/// Values to begin with: a flat scale, and thresholds at the shares of the ratings.
Vector start_of(const ScaleLayout& layout, const ScaleAnswers& answers) {
  Vector x(layout.size(), 0.0);
  if (layout.levels.empty()) return x;
  x[layout.slope_place()] = 0.5;
  double all = 0, below = 0;
  for (const RatingCount& one : answers.ratings) all += one.count;
  for (std::size_t c = 0; c + 1 < layout.levels.size(); ++c) {
    for (const RatingCount& one : answers.ratings)
      if (one.score == layout.levels[c]) below += one.count;
    x[layout.slope_place() + 1 + c] = normal_quantile(below / all);
  }
  return x;
}

}  // namespace

double scale_log_likelihood(const ScaleAnswers& answers, const ScaleLayout& layout, std::span<const double> x,
                            std::span<double> gradient) {
  double sum = 0;
  for (const PairCount& pair : answers.pairs) {
    const double difference = ScaleLayout::value(x, pair.first) - ScaleLayout::value(x, pair.second) +
                              (layout.order ? x[layout.order_place()] : 0);
    double slope = 0;
    const auto count = [&](double answered, double lower, double upper) {
      if (answered == 0) return;
      const CategoryTerm term = category_term(Link::Probit, lower, upper, difference / jod_sigma);
      sum += answered * term.log_p;
      slope += answered * term.d1 / jod_sigma;
    };
    count(pair.first_chosen, 0, infinite);
    count(pair.second_chosen, -infinite, 0);
    ScaleLayout::add(gradient, pair.first, slope);
    ScaleLayout::add(gradient, pair.second, -slope);
    if (layout.order) gradient[layout.order_place()] += slope;
  }
  if (answers.ratings.empty()) return sum;
  const std::size_t k = layout.slope_place();
  for (const RatingCount& rating : answers.ratings) {
    const auto above = std::upper_bound(layout.levels.begin(), layout.levels.end(), rating.score);
    const auto level =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - layout.levels.begin() - 1, 0));
    const bool lowest = level == 0, highest = level + 1 == layout.levels.size();
    const double q = ScaleLayout::value(x, rating.condition);
    const CategoryTerm term = category_term(Link::Probit, lowest ? -infinite : x[k + level],
                                            highest ? infinite : x[k + level + 1], x[k] * q);
    sum += rating.count * term.log_p;
    ScaleLayout::add(gradient, rating.condition, rating.count * term.d1 * x[k]);
    gradient[k] += rating.count * term.d1 * q;
    if (!lowest) gradient[k + level] += rating.count * term.lo;
    if (!highest) gradient[k + level + 1] += rating.count * term.up;
  }
  return sum;
}

ScaleAnswers summed_answers(const ScaleData& data, const int* left_out) {
  std::map<std::pair<int, int>, PairCount> pairs;
  std::map<std::pair<int, int>, RatingCount> ratings;
  for (const PairCount& one : data.pairs) {
    if (left_out && one.person == *left_out) continue;
    auto& cell =
        pairs.try_emplace({one.first, one.second}, PairCount{0, one.first, one.second}).first->second;
    cell.first_chosen += one.first_chosen;
    cell.second_chosen += one.second_chosen;
  }
  for (const RatingCount& one : data.ratings) {
    if (left_out && one.person == *left_out) continue;
    ratings.try_emplace({one.condition, one.score}, RatingCount{0, one.condition, one.score, 0})
        .first->second.count += one.count;
  }
  ScaleAnswers out;
  for (const auto& [key, cell] : pairs)
    if (cell.first_chosen + cell.second_chosen > 0) out.pairs.push_back(cell);
  for (const auto& [key, cell] : ratings)
    if (cell.count > 0) out.ratings.push_back(cell);
  return out;
}

std::vector<std::vector<int>> answer_groups(const ScaleAnswers& answers, int conditions, bool by_ratings) {
  std::vector<int> group(at(conditions));
  std::iota(group.begin(), group.end(), 0);
  const auto join = [&](int a, int b) {
    const int from = group[at(a)], to = group[at(b)];
    if (from != to) std::replace(group.begin(), group.end(), std::max(from, to), std::min(from, to));
  };
  for (const PairCount& pair : answers.pairs) join(pair.first, pair.second);
  if (by_ratings)
    for (const RatingCount& one : answers.ratings) join(answers.ratings.front().condition, one.condition);
  std::map<int, std::vector<int>> sets;
  for (int i = 0; i < conditions; ++i) sets[group[at(i)]].push_back(i);
  std::vector<std::vector<int>> out;
  for (auto& [first, set] : sets) out.push_back(std::move(set));
  return out;
}

std::vector<double> ScaleMaximum::jod() const {
  Vector q(at(layout.conditions));
  double mean = 0;
  for (int i = 0; i < layout.conditions; ++i) mean += ScaleLayout::value(x, i) / layout.conditions;
  for (int i = 0; i < layout.conditions; ++i) q[at(i)] = ScaleLayout::value(x, i) - mean;
  return q;
}

Result<ScaleMaximum> maximise_scale(const ScaleData& data, const ScaleOptions& options, const int* left_out,
                                    const ScaleMaximum* near) {
  ScaleMaximum out{{data.conditions, options.order_bias}, summed_answers(data, left_out), {}, {}, 0};
  if (const std::string why = undetermined(out.answers, data, options); !why.empty()) return Refusal{why};
  std::set<int> levels;
  for (const RatingCount& one : out.answers.ratings) levels.insert(one.score);
  out.layout.levels.assign(levels.begin(), levels.end());
  const Vector unanimous = unanimous_pairs(out.answers);
  const Objective objective = [&](std::span<const double> x, std::span<double> gradient) {
    std::fill(gradient.begin(), gradient.end(), 0.0);
    for (std::size_t t = out.layout.slope_place() + 2; t < x.size(); ++t)
      if (!(x[t] > x[t - 1])) return infinite;
    const double value = scale_log_likelihood(out.answers, out.layout, x, gradient) +
                         log_prior(options.prior, unanimous, out.layout, x, gradient);
    for (double& slope : gradient) slope = -slope;
    return std::isfinite(value) ? -value : infinite;
  };
  const bool alike = near && near->x.size() == out.layout.size() && near->layout.levels == out.layout.levels;
  Minimum found;
  if (alike) found = minimise_near(objective, near->x, near->inverse);
  if (!found.converged) found = minimise(objective, start_of(out.layout, out.answers));
  if (const std::string why = unbounded(found, out.layout); !why.empty()) return Refusal{why};
  out.x = found.x;
  if (!found.hessian.empty()) {
    const auto factor = Cholesky::of(found.hessian);
    if (!factor) return Refusal{"the answers do not determine every estimate"};
    out.inverse = factor->inverse();
  }
  Vector unused(out.x.size());
  out.log_likelihood = scale_log_likelihood(out.answers, out.layout, out.x, unused);
  return out;
}

}  // namespace stats
