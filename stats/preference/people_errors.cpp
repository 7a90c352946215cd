#include "stats/preference/people_errors.hpp"

#include <cmath>
#include <map>

#include "stats/inference/distributions.hpp"
#include "stats/inference/tails.hpp"
#include "stats/quantiles.hpp"

namespace stats {

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
    Values step(k, 0.0);  // how far this person's answers move the coefficients
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) step[i] += fit.variance(i, j) * score[j];
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) out.covariance[i * k + j] += step[i] * step[j] * n / (n - 1);
  }
  // If all people answer alike, only rounding remains compared with the errors of independent answers.
  for (std::size_t i = 0; i < k; ++i) {
    if (!(out.covariance[i * k + i] > 1e-10 * fit.variance(i, i)))
      return Refusal{"the participants answered too much alike for errors over people"};
  }
  return out;
}

}  // namespace stats
