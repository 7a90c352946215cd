#include "stats/ordinal/rival_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/ordinal/rows.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

constexpr double largest_rival_sd = 30;
constexpr int scoring_points = 25;  ///< nodes of the quadrature for the score of one person
/// A fold counts as fitted if its gradient is below this: the objective is then within about 1e-5 of its
/// minimum.
constexpr double small_slope = 1e-2;

/// Answers of some people as MixedLikelihood takes them.
struct Part {
  std::vector<std::size_t> rows;  ///< rows of RivalAnswers
  std::vector<int> category, participant;
  std::vector<int> scores;

  std::size_t thresholds() const { return scores.size() - 1; }
};

Part part_of(const RivalAnswers& answers, std::span<const char> in) {
  Part part;
  std::vector<int> place(static_cast<std::size_t>(answers.choices), -1);
  std::map<int, int> people;
  for (std::size_t i = 0; i < answers.n(); ++i) {
    if (!in[static_cast<std::size_t>(answers.person[i])]) continue;
    part.rows.push_back(i);
    place[static_cast<std::size_t>(answers.score[i])] = 0;
    part.participant.push_back(
        people.emplace(answers.person[i], static_cast<int>(people.size())).first->second);
  }
  for (int c = 0; c < answers.choices; ++c) {
    if (place[static_cast<std::size_t>(c)] < 0) continue;
    place[static_cast<std::size_t>(c)] = static_cast<int>(part.scores.size());
    part.scores.push_back(c);
  }
  for (const std::size_t i : part.rows)
    part.category.push_back(place[static_cast<std::size_t>(answers.score[i])]);
  return part;
}

void check_rivals(const RivalModel& model, const RivalAnswers& answers, const RivalOptions& options) {
  const auto fail = [&](const std::string& what) {
    throw std::invalid_argument("RivalFitter: model '" + model.name + "': " + what);
  };
  if (answers.person.size() != answers.n()) fail("give one person for each answer");
  if (answers.choices < 2) fail("give at least two choices");
  for (std::size_t i = 0; i < answers.n(); ++i) {
    if (answers.score[i] < 0 || answers.score[i] >= answers.choices)
      fail("give scores from 0 to choices - 1");
    if (answers.person[i] < 0 || answers.person[i] >= answers.people)
      fail("give persons from 0 to people - 1");
  }
  if (!model.linear && model.predictors.empty()) fail("give a predictor, or make it linear");
  for (const Predictor& one : model.predictors) {
    if (one.values.size() != answers.n()) fail("give one value of " + one.name + " for each answer");
    for (const double v : one.values)
      if (!std::isfinite(v)) fail("give finite values of " + one.name);
  }
  if (options.lapse && !(*options.lapse >= 0 && *options.lapse <= largest_lapse))
    fail("give a lapse rate from 0 to 0.5");
}

}  // namespace

struct RivalFitter::Parts {
  RivalModel model;
  RivalAnswers answers;
  RivalOptions options;
  std::vector<double> x;  ///< standardised predictors, row by row
  std::vector<double> centre, scale;
  std::string constant;                       ///< name of a predictor that does not vary
  std::vector<double> best, inverse_hessian;  ///< of fit()

  std::size_t width() const { return model.predictors.size(); }
  std::size_t coefficients() const { return model.linear ? width() : width() + 1; }
  bool estimates_lapse() const { return !options.lapse; }

  /// The lapse rate as a function of the parameter t that the minimiser varies; t = 0 gives the least rate.
  /// Sets `slope` to the derivative of the rate for t.
  double lapse_of(double t, double& slope) const {
    if (options.lapse) {
      slope = 0;
      return *options.lapse;
    }
    return lapse_rate(t, options.least_lapse, slope);
  }

  double location(std::span<const double> b, std::span<const double> values) const {
    double sum = 0;
    if (model.linear) {
      for (std::size_t j = 0; j < values.size(); ++j) sum += b[j] * values[j];
      return sum;
    }
    const double v = combined_at(b, values);
    return v * (b[0] + b[1] * v);
  }
  double combined_at(std::span<const double> b, std::span<const double> values) const {
    double v = values[0];
    for (std::size_t j = 1; j < values.size(); ++j) v -= b[j + 1] * values[j];
    return v;
  }
  /// Minus the log prior of thresholds and coefficients.
  double penalty(std::span<const double> of) const {
    double out = 0;
    for (const double one : of) out += one * one / (2 * options.prior_sd * options.prior_sd);
    return out;
  }
  std::span<const double> row(std::size_t i) const { return std::span(x).subspan(i * width(), width()); }

  /// Adds the derivatives of the location at a row, times `slope`, to those of the coefficients.
  void add_slopes(std::span<const double> b, std::span<const double> values, double slope,
                  std::span<double> out) const {
    if (model.linear) {
      for (std::size_t j = 0; j < values.size(); ++j) out[j] += slope * values[j];
      return;
    }
    const double v = combined_at(b, values), by_v = b[0] + 2 * b[1] * v;
    out[0] += slope * v;
    out[1] += slope * v * v;
    for (std::size_t j = 1; j < values.size(); ++j) out[j + 1] -= slope * by_v * values[j];
  }

  Objective deviance(MixedLikelihood& likelihood, const Part& part) const {
    return [this, &likelihood, &part](std::span<const double> at, std::span<double> gradient) {
      const std::size_t q = part.thresholds(), k = coefficients();
      const auto b = at.subspan(q, k);
      const double sd = at[q + k], t = estimates_lapse() ? at[q + k + 1] : 0;
      if (std::abs(sd) > largest_rival_sd) return std::numeric_limits<double>::infinity();
      double lapse_slope = 0;
      const double lapse = lapse_of(t, lapse_slope);
      std::vector<double> place;
      for (const std::size_t i : part.rows) place.push_back(location(b, row(i)));
      MixedGradient slopes;
      double value = -likelihood.evaluate(at.first(q), place, sd, slopes, {lapse, answers.choices});
      std::fill(gradient.begin(), gradient.end(), 0.0);
      for (std::size_t j = 0; j < q; ++j) gradient[j] = -slopes.thresholds[j];
      for (std::size_t i = 0; i < part.rows.size(); ++i)
        add_slopes(b, row(part.rows[i]), -slopes.location[i], gradient.subspan(q, k));
      value += penalty(at.first(q + k));
      for (std::size_t j = 0; j < q + k; ++j) gradient[j] += at[j] / (options.prior_sd * options.prior_sd);
      gradient[q + k] = -slopes.sd;
      if (estimates_lapse()) {
        value += t * t / 2;
        gradient[q + k + 1] = t - slopes.lapse * lapse_slope;
      }
      return value;
    };
  }

  /// Starts of the search: thresholds of the answers alone, a slope with the sign of the correlation, and for
  /// each further predictor both signs of its coefficient.
  std::vector<std::vector<double>> starts(const Part& part) const {
    auto start = marginal_thresholds(part.category, static_cast<int>(part.scores.size()), Link::Probit);
    const std::size_t q = start.size();
    start.resize(q + coefficients());
    if (!model.linear) {
      double together = 0;
      for (std::size_t i = 0; i < part.rows.size(); ++i) together += row(part.rows[i])[0] * part.category[i];
      start[q] = together < 0 ? -0.7 : 0.7;
    }
    start.push_back(0.5);
    if (estimates_lapse()) start.push_back(0.2);
    std::vector<std::vector<double>> all{start};
    for (std::size_t j = 1; !model.linear && j < width(); ++j) {
      for (const double c : {-0.7, 0.7}) {
        all.push_back(start);
        all.back()[q + j + 1] = c;
      }
    }
    return all;
  }

  RivalFit fit_of(std::span<const double> at, double value, const Part& part) const {
    const std::size_t q = part.thresholds(), k = coefficients();
    RivalFit fit;
    fit.scores = part.scores;
    fit.thresholds.assign(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(q));
    const auto b = at.subspan(q, k);
    fit.coefficients.assign(b.begin(), b.end());
    fit.sd_person = std::abs(at[q + k]);
    double ignored = 0;
    const double t = estimates_lapse() ? at[q + k + 1] : 0;
    fit.lapse = lapse_of(t, ignored);
    fit.log_likelihood = -value + t * t / 2 + penalty(at.first(q + k));
    fit.parameters = static_cast<int>(at.size());
    return fit;
  }

  std::string why_not(const Part& part) const {
    if (!constant.empty()) return constant + " is the same in all trials";
    if (part.participant.empty() || *std::max_element(part.participant.begin(), part.participant.end()) < 1)
      return "there are fewer than two people";
    if (part.scores.size() < 2) return "all answers are equal";
    return "";
  }
};

RivalFitter::RivalFitter(RivalModel model, const RivalAnswers& answers, const RivalOptions& options)
    : parts_(std::make_unique<Parts>()) {
  check_rivals(model, answers, options);
  Parts& p = *parts_;
  p.model = std::move(model);
  p.answers = answers;
  p.options = options;
  const double n = static_cast<double>(answers.n());
  for (const Predictor& one : p.model.predictors) {
    double mean = 0, squares = 0, size = 0;
    for (const double v : one.values) mean += v / n;
    for (const double v : one.values) {
      squares += (v - mean) * (v - mean) / n;
      size = std::max(size, std::abs(v));
    }
    const double sd = std::sqrt(squares);
    if (!(sd > 1e-6 * size)) p.constant = one.name;  // nanoseconds of the record are no difference
    p.centre.push_back(mean);
    p.scale.push_back(sd > 0 ? sd : 1);
  }
  for (std::size_t i = 0; i < answers.n(); ++i)
    for (std::size_t j = 0; j < p.width(); ++j)
      p.x.push_back((p.model.predictors[j].values[i] - p.centre[j]) / p.scale[j]);
}
RivalFitter::~RivalFitter() = default;
RivalFitter::RivalFitter(RivalFitter&&) noexcept = default;

const RivalModel& RivalFitter::model() const { return parts_->model; }

Result<RivalFit> RivalFitter::fit() {
  Parts& p = *parts_;
  const std::vector<char> everyone(static_cast<std::size_t>(p.answers.people), 1);
  const Part part = part_of(p.answers, everyone);
  if (const auto reason = p.why_not(part); !reason.empty()) return Refusal{reason};
  std::optional<Minimum> best;
  for (auto& start : p.starts(part)) {
    MixedLikelihood likelihood(part.category, part.participant, Link::Probit, p.options.points);
    auto found = minimise(p.deviance(likelihood, part), std::move(start));
    if (found.converged && (!best || found.value < best->value - 1e-9)) best = std::move(found);
  }
  if (!best) return Refusal{"the fit did not converge"};
  p.best = best->x;
  p.inverse_hessian = Cholesky::of(best->hessian)->inverse();
  return p.fit_of(best->x, best->value, part);
}

Result<RivalFit> RivalFitter::fit_some(std::span<const char> in) const {
  const Parts& p = *parts_;
  if (p.best.empty())
    throw std::invalid_argument("RivalFitter: fit_some() starts from fit(); call fit() first");
  const Part part = part_of(p.answers, in);
  if (const auto reason = p.why_not(part); !reason.empty()) return Refusal{reason};
  MixedLikelihood likelihood(part.category, part.participant, Link::Probit, p.options.points);
  const auto objective = p.deviance(likelihood, part);
  const std::size_t q = part.thresholds();
  std::optional<Minimum> best;
  if (q + p.coefficients() + 1 + (p.estimates_lapse() ? 1 : 0) == p.best.size()) {
    best = minimise_near(objective, p.best, p.inverse_hessian);
  } else {  // a score does not occur in this part
    auto start = marginal_thresholds(part.category, static_cast<int>(part.scores.size()), Link::Probit);
    start.insert(start.end(), p.best.end() - static_cast<std::ptrdiff_t>(p.best.size() - whole_thresholds()),
                 p.best.end());
    best = minimise(objective, std::move(start));
  }
  if (!best->converged) {
    std::vector<double> slope(best->x.size());
    objective(best->x, slope);
    for (const double s : slope)
      if (!(std::abs(s) < small_slope)) return Refusal{"the fit did not converge"};
  }
  return p.fit_of(best->x, best->value, part);
}

std::size_t RivalFitter::whole_thresholds() const {
  const Parts& p = *parts_;
  return p.best.size() - p.coefficients() - 1 - (p.estimates_lapse() ? 1 : 0);
}

double RivalFitter::log_score(const RivalFit& fit, int person) const {
  const Parts& p = *parts_;
  double score = 0;
  std::vector<int> category, one;
  std::vector<double> place;
  for (std::size_t i = 0; i < p.answers.n(); ++i) {
    if (p.answers.person[i] != person) continue;
    const auto at = std::lower_bound(fit.scores.begin(), fit.scores.end(), p.answers.score[i]);
    if (at == fit.scores.end() || *at != p.answers.score[i]) {  // only a guess gives this score
      score += std::log(fit.lapse / p.answers.choices);
      continue;
    }
    category.push_back(static_cast<int>(at - fit.scores.begin()));
    one.push_back(0);
    place.push_back(p.location(fit.coefficients, p.row(i)));
  }
  if (category.empty()) return score;
  MixedLikelihood likelihood(category, one, Link::Probit, scoring_points);
  MixedGradient ignored;
  return score +
         likelihood.evaluate(fit.thresholds, place, fit.sd_person, ignored, {fit.lapse, p.answers.choices});
}

std::vector<double> RivalFitter::probabilities(const RivalFit& fit, std::span<const double> values) const {
  const Parts& p = *parts_;
  std::vector<double> z;
  for (std::size_t j = 0; j < values.size(); ++j) z.push_back((values[j] - p.centre[j]) / p.scale[j]);
  const double place = p.location(fit.coefficients, z), s = std::sqrt(1 + fit.sd_person * fit.sd_person);
  std::vector<double> out(static_cast<std::size_t>(p.answers.choices), fit.lapse / p.answers.choices);
  double below = 0;
  for (std::size_t j = 0; j < fit.scores.size(); ++j) {
    const double up = j < fit.thresholds.size() ? normal_probability((fit.thresholds[j] - place) / s) : 1;
    out[static_cast<std::size_t>(fit.scores[j])] += (1 - fit.lapse) * (up - below);
    below = up;
  }
  return out;
}

std::vector<double> RivalFitter::probabilities(const RivalFit& fit, std::size_t row) const {
  std::vector<double> values;
  for (const Predictor& one : parts_->model.predictors) values.push_back(one.values[row]);
  return probabilities(fit, values);
}

std::vector<double> RivalFitter::combined(const RivalFit& fit) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < parts_->answers.n(); ++i)
    out.push_back(parts_->combined_at(fit.coefficients, parts_->row(i)));
  return out;
}

std::vector<double> RivalFitter::ratios(const RivalFit& fit) const {
  std::vector<double> out;
  for (std::size_t j = 1; !parts_->model.linear && j < parts_->width(); ++j)
    out.push_back(fit.coefficients[j + 1] * parts_->scale[0] / parts_->scale[j]);
  return out;
}

}  // namespace stats
