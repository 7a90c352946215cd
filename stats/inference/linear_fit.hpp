#pragma once
/// Ordinary least squares.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// A field is empty if the data have too few degrees of freedom for it.
struct LinearFit {
  /// The intercept (if any), then one coefficient for each column in order.
  std::vector<double> coefficients;
  std::vector<double> standard_errors;  ///< empty if df = 0
  std::size_t n = 0, n_missing = 0;
  double rss = 0;
  double df = 0;                      ///< n - number of coefficients
  std::optional<double> residual_sd;  ///< sqrt(rss / df)
  std::optional<double> r2;  ///< about the mean of y with an intercept, about zero without one; empty if y
                             ///< does not vary about it
  /// F test that all slopes are zero. Empty without slopes, if df = 0, if r2 is empty, or if y is fitted
  /// perfectly.
  std::optional<double> f, f_p;
};

/// Fits y by a linear combination of columns of equal length. Householder QR with scaled columns in
/// double-double, so that results of nearly collinear data (Longley, Wampler) are accurate. A row with a NaN
/// counts as missing. std::invalid_argument when lengths differ. Refused: fewer rows than coefficients, an
/// infinite value, a column that is a linear combination of others.
Result<LinearFit> fit_linear(const std::vector<std::vector<double>>& columns, std::span<const double> y,
                             bool intercept = true);
}  // namespace stats
