#include "stats/preference/logit_fit.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "stats/gsl_errors.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Values = std::vector<double>;

double log_logistic(double x) { return x < 0 ? x - std::log1p(std::exp(x)) : -std::log1p(std::exp(-x)); }

double predictor(const LogitRow& row, const Values& beta) {
  double sum = 0;
  for (std::size_t j = 0; j < beta.size(); ++j) sum += row.design[j] * beta[j];
  return sum;
}

double log_likelihood(std::span<const LogitRow> rows, const Values& beta) {
  double sum = 0;
  for (const auto& row : rows) {
    const double eta = predictor(row, beta), failures = row.trials - row.successes;
    // 0 times -infinity counts as 0.
    if (row.successes > 0) sum += row.successes * log_logistic(eta);
    if (failures > 0) sum += failures * log_logistic(-eta);
  }
  return sum;
}

double deviance(std::span<const LogitRow> rows, const Values& beta) {
  double sum = 0;
  for (const auto& row : rows) {
    const double eta = predictor(row, beta);
    sum += deviance_part(row.successes, row.trials * logistic(eta)) +
           deviance_part(row.trials - row.successes, row.trials * logistic(-eta));
  }
  return 2 * sum;
}

/// Inverse of the information matrix, and log determinant of the information matrix. information() is empty
/// if the matrix is singular.
struct FitInformation {
  Values inverse;
  double log_determinant = 0;
};

std::optional<FitInformation> information(std::span<const LogitRow> rows, const Values& beta) {
  const std::size_t k = beta.size();
  FitInformation out{Values(k * k, 0.0)};
  for (const auto& row : rows) {
    const double eta = predictor(row, beta);
    const double weight = row.trials * logistic(eta) * logistic(-eta);
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) out.inverse[i * k + j] += weight * row.design[i] * row.design[j];
  }
  Values diagonal(k);
  for (std::size_t i = 0; i < k; ++i) diagonal[i] = out.inverse[i * k + i];
  auto view = gsl_matrix_view_array(out.inverse.data(), k, k);
  if (gsl_linalg_cholesky_decomp1(&view.matrix) != GSL_SUCCESS) return std::nullopt;
  for (std::size_t i = 0; i < k; ++i) {
    const double pivot = out.inverse[i * k + i];
    // The column is a linear combination of the others, up to rounding.
    if (!(pivot * pivot > 1e-12 * diagonal[i])) return std::nullopt;
    out.log_determinant += 2 * std::log(pivot);
  }
  if (gsl_linalg_cholesky_invert(&view.matrix) != GSL_SUCCESS) return std::nullopt;
  return out;
}

/// The score (gradient of the objective). Firth's term for LogitBias::Reduced adds leverage * trials *
/// variance * (1/2 - probability) to a row's residual.
Values score(std::span<const LogitRow> rows, const Values& beta, const Values& inverse, LogitBias bias) {
  const std::size_t k = beta.size();
  Values out(k, 0.0);
  for (const auto& row : rows) {
    const double eta = predictor(row, beta), p = logistic(eta);
    double residual = row.successes - row.trials * p;
    if (bias == LogitBias::Reduced) {
      double leverage = 0;
      for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < k; ++j) leverage += row.design[i] * inverse[i * k + j] * row.design[j];
      residual += leverage * row.trials * p * logistic(-eta) * (0.5 - p);
    }
    for (std::size_t j = 0; j < k; ++j) out[j] += residual * row.design[j];
  }
  return out;
}

/// The objective that Newton's method maximises: the log-likelihood, plus half the information's log
/// determinant if the bias is reduced.
double objective(std::span<const LogitRow> rows, const Values& beta, const FitInformation& at,
                 LogitBias bias) {
  return log_likelihood(rows, beta) + (bias == LogitBias::Reduced ? at.log_determinant / 2 : 0);
}

struct Step {
  Values beta;
  FitInformation information;
  double objective = 0;
};

/// beta + step, with the step halved until the objective does not fall. Empty if it always falls.
std::optional<Step> climb(std::span<const LogitRow> rows, const Step& from, const Values& step,
                          LogitBias bias) {
  const double rounding = 1e-13 * (1 + std::abs(from.objective));
  double part = 1;
  for (int halving = 0; halving < 40; ++halving, part /= 2) {
    Values beta = from.beta;
    for (std::size_t j = 0; j < beta.size(); ++j) beta[j] += part * step[j];
    auto at = information(rows, beta);
    if (!at) continue;
    const double value = objective(rows, beta, *at, bias);
    if (value >= from.objective - rounding) return Step{std::move(beta), std::move(*at), value};
  }
  return std::nullopt;
}

double largest(const Values& values) {
  double out = 0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

}  // namespace

Result<LogitFit> fit_logit(std::span<const LogitRow> rows, LogitBias bias) {
  use_gsl_codes();
  if (rows.empty()) return Refusal{"no observations"};
  const std::size_t k = rows.front().design.size();
  Step at{.beta = Values(k, 0.0), .information = {}};
  const auto start = information(rows, at.beta);
  if (!start) return Refusal{"the comparisons do not determine every coefficient"};
  at.information = *start;
  at.objective = objective(rows, at.beta, at.information, bias);

  // Under separation the likelihood has no maximum: it keeps rising as the coefficients grow, and each of
  // Newton's steps adds about 1 to a linear predictor. A linear predictor beyond `farthest` is refused.
  constexpr int most_steps = 200;
  constexpr double farthest = 30;
  for (int i = 0; i < most_steps; ++i) {
    const Values slope = score(rows, at.beta, at.information.inverse, bias);
    Values step(k, 0.0);
    for (std::size_t r = 0; r < k; ++r)
      for (std::size_t c = 0; c < k; ++c) step[r] += at.information.inverse[r * k + c] * slope[c];
    auto next = climb(rows, at, step, bias);
    double reach = 0;
    for (const auto& row : rows)
      reach = std::max(reach, std::abs(predictor(row, next ? next->beta : at.beta)));
    if (!next || reach > farthest) {
      return Refusal{bias == LogitBias::AsIs ? "the choices are separated: an estimate is infinite"
                                             : "the fit did not converge"};
    }
    at = std::move(*next);
    if (largest(step) < 1e-11 * (1 + largest(at.beta))) {
      return LogitFit{at.beta, at.information.inverse, log_likelihood(rows, at.beta),
                      deviance(rows, at.beta)};
    }
  }
  return Refusal{"the fit did not converge"};
}

void check_trials(std::span<const Comparison> trials, int items) {
  const auto outside = [items](int item) { return item < 0 || item >= items; };
  for (const auto& t : trials) {
    if (outside(t.first) || outside(t.second) || t.first == t.second || !std::isfinite(t.position))
      throw std::invalid_argument(
          "paired comparisons: a trial has an item outside the list, one item twice or no finite position; "
          "leave it out or mend it");
  }
}

std::vector<double> win_table(std::span<const Comparison> trials, int items) {
  const auto n = static_cast<std::size_t>(items);
  std::vector<double> wins(n * n, 0.0);
  for (const auto& t : trials) {
    const int winner = t.first_chosen ? t.first : t.second, loser = t.first_chosen ? t.second : t.first;
    wins[static_cast<std::size_t>(winner) * n + static_cast<std::size_t>(loser)] += 1;
  }
  return wins;
}

std::vector<LogitRow> trial_rows(std::span<const Comparison> trials, int items, std::size_t terms) {
  std::vector<LogitRow> rows;
  for (const auto& t : trials) {
    LogitRow row{std::vector<double>(static_cast<std::size_t>(items - 1) + terms, 0.0),
                 t.first_chosen ? 1.0 : 0.0, 1};
    if (t.first > 0) row.design[static_cast<std::size_t>(t.first - 1)] = 1;
    if (t.second > 0) row.design[static_cast<std::size_t>(t.second - 1)] = -1;
    rows.push_back(std::move(row));
  }
  return rows;
}

namespace {

using Values = std::vector<double>;

/// Each person's score (gradient of the log-likelihood).
std::map<int, Values> scores_of_people(const LogitFit& fit, std::span<const LogitRow> rows,
                                       std::span<const Comparison> trials) {
  const std::size_t k = fit.coefficients.size();
  std::map<int, Values> people;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double predictor = 0;
    for (std::size_t j = 0; j < k; ++j) predictor += rows[r].design[j] * fit.coefficients[j];
    const double residual = rows[r].successes - rows[r].trials / (1 + std::exp(-predictor));
    Values& score = people.try_emplace(trials[r].participant, k, 0.0).first->second;
    for (std::size_t j = 0; j < k; ++j) score[j] += residual * rows[r].design[j];
  }
  return people;
}

}  // namespace

double CoefficientErrors::quantile(double confidence) const {
  return df ? student_upper_quantile(0.5 - confidence / 2, *df) : normal_quantile(0.5 + confidence / 2);
}

double CoefficientErrors::p(double t) const {
  return df ? student_p(t, *df, Alternative::TwoSided) : normal_two_sided(t);
}

CoefficientErrors independent_errors(const LogitFit& fit) { return {fit.covariance, {}}; }

Result<CoefficientErrors> people_errors(const LogitFit& fit, std::span<const LogitRow> rows,
                                        std::span<const Comparison> trials) {
  const std::size_t k = fit.coefficients.size();
  const auto people = scores_of_people(fit, rows, trials);
  if (people.size() <= k)
    return Refusal{std::to_string(people.size()) + (people.size() == 1 ? " person is" : " people are") +
                   " too few for errors over people of " + std::to_string(k) + " coefficients"};
  const auto n = static_cast<double>(people.size());
  CoefficientErrors out{Values(k * k, 0.0), n - 1};
  for (const auto& [person, score] : people) {
    Values step(k, 0.0);  // this person's contribution to the coefficients: inverse information times score
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) step[i] += fit.variance(i, j) * score[j];
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) out.covariance[i * k + j] += step[i] * step[j] * n / (n - 1);
  }
  // If all people answer alike, the covariance over people is only rounding.
  for (std::size_t i = 0; i < k; ++i) {
    if (!(out.covariance[i * k + i] > 1e-10 * fit.variance(i, i)))
      return Refusal{"the participants answered too much alike for errors over people"};
  }
  return out;
}

}  // namespace stats
