#pragma once
/// Reliability: how well several questions measure the same thing.

#include <array>
#include <span>

#include "stats/result.hpp"

namespace stats {

/// Cronbach's (1951) alpha = k / (k - 1) (1 - sum of the items' variances / variance of their sum), with
/// Feldt's (1965) interval: (1 - true alpha) / (1 - alpha) has Fisher's F with n - 1 and (n - 1)(k - 1)
/// degrees of freedom, where the items are essentially parallel and the values normal.
struct CronbachAlpha {
  int items = 0, n = 0, n_missing = 0;  ///< n_missing: people left out because they lack an item
  double alpha = 0;                     ///< below 0 if the items' covariances sum to less than 0
  std::array<double, 2> ci{};
};

/// `rows`: people by items, row after row; NaN = missing. Refused: fewer than two items or complete people,
/// an infinite value, sums that are all equal. std::invalid_argument when the values do not fill whole rows
/// or confidence is outside (0, 1).
Result<CronbachAlpha> cronbach_alpha(std::span<const double> rows, int items, double confidence = 0.95);

}  // namespace stats
