#pragma once
/// Logistic regression on small tables, used by the preference models: the fit, single trials of paired
/// comparisons as its rows, and errors that allow for dependence between the answers of one person.

#include <cmath>
#include <optional>
#include <span>
#include <string>
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
  double log_likelihood = 0;       ///< leaves out the binomial coefficients
  double deviance = 0;             ///< deviance against a free proportion in each row

  double variance(std::size_t i, std::size_t j) const { return covariance[i * coefficients.size() + j]; }
};

enum class LogitBias {
  AsIs,     ///< maximum likelihood
  Reduced,  ///< Firth 1993: maximises likelihood times Jeffreys' prior; finite under separation
};

/// Fits the coefficients by Newton's method with step halving. All rows have the same number of coefficients,
/// one or more. Refused: no rows, coefficients that the rows do not determine, separation (LogitBias::AsIs),
/// no convergence.
Result<LogitFit> fit_logit(std::span<const LogitRow> rows, LogitBias bias = LogitBias::AsIs);

/// One 2AFC trial.
struct Comparison {
  int first = 0, second = 0;  ///< items shown in the first and the second interval, from 0
  bool first_chosen = false;
  double position = 0;  ///< position of the trial in its session; any unit
  int participant = 0;  ///< any number; equal numbers are one participant
};

/// Throws std::invalid_argument for an item outside [0, items), equal items, or a position that is not
/// finite.
void check_trials(std::span<const Comparison> trials, int items);

/// Counts of wins for bradley_terry(): items by items, row after row; entry (i, j) is how often i was
/// preferred to j.
std::vector<double> win_table(std::span<const Comparison> trials, int items);

/// One row for each trial, a success if the first item was chosen. The design has a column for the strength
/// of each item except item 0 (1 for the item in the first interval, -1 for the one in the second), then
/// `terms` columns of zeros for the caller to fill.
std::vector<LogitRow> trial_rows(std::span<const Comparison> trials, int items, std::size_t terms = 0);

/// The covariance of estimated coefficients, and the distribution of an estimate over its standard error.
struct CoefficientErrors {
  std::vector<double> covariance;  ///< coefficients by coefficients, row after row
  std::optional<double> df;        ///< degrees of freedom of Student's t; empty: normal distribution

  double variance(std::size_t i, std::size_t j, std::size_t size) const { return covariance[i * size + j]; }
  double quantile(double confidence) const;  ///< half width of the interval in standard errors
  double p(double t) const;                  ///< two-sided p of an estimate t standard errors from 0
};

/// Errors as if answers were independent: the inverse information.
CoefficientErrors independent_errors(const LogitFit& fit);

/// Errors by the sandwich estimator with each person's answers as a cluster (Liang and Zeger 1986), times
/// people / (people - 1), with Student's t of people - 1 degrees of freedom. `rows` as they were fitted, one
/// for each of `trials`. Refused: no more people than coefficients, since their answers then do not span the
/// coefficients; people who answer so much alike that a coefficient's variance over people is only rounding.
Result<CoefficientErrors> people_errors(const LogitFit& fit, std::span<const LogitRow> rows,
                                        std::span<const Comparison> trials);

}  // namespace stats
