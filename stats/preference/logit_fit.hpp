#pragma once
/// Logistic regression on small tables, used by the preference models.

#include <cmath>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

inline double logistic(double x) { return 1 / (1 + std::exp(-x)); }

/// One row of the table: `design` has one value for each coefficient.
struct LogitRow {
  std::vector<double> design;
  double successes = 0, trials = 0;  ///< 0 <= successes <= trials, need not be whole
};

struct LogitFit {
  std::vector<double> coefficients;
  std::vector<double> covariance;  ///< inverse information, row after row
  double log_likelihood = 0;       ///< without binomial coefficients
  double deviance = 0;             ///< against a free proportion in each row

  double variance(std::size_t i, std::size_t j) const { return covariance[i * coefficients.size() + j]; }
};

enum class LogitBias {
  AsIs,     ///< maximum likelihood
  Reduced,  ///< Firth 1993: maximises likelihood times Jeffreys' prior; finite under separation
};

/// Newton's method with step halving. All rows have the same number of coefficients, one or more. Refused:
/// coefficients that the rows do not determine, separation (LogitBias::AsIs), no convergence.
Result<LogitFit> fit_logit(std::span<const LogitRow> rows, LogitBias bias = LogitBias::AsIs);

}  // namespace stats
