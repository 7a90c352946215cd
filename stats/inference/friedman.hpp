#pragma once
/// Friedman's rank test of k related conditions.

#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

struct Friedman {
  int n = 0;          ///< participants used
  int n_missing = 0;  ///< participants dropped because they lack a value
  int k = 0;          ///< conditions
  double chi2 = 0;    ///< corrected for ties
  int df = 0;
  double p = 0;          ///< p of chi2; accurate for large n
  double kendall_w = 0;  ///< agreement of the participants, 0 to 1
  /// Iman and Davenport's (1980) F. In small samples its rate of false positives is closer to the nominal
  /// level than that of chi2. Infinite, with p = 0, if all participants have the same order.
  double iman_davenport_f = 0;
  double df1 = 0, df2 = 0;
  double iman_davenport_p = 0;
  /// Mean rank of each condition, 1 = smallest value; ties share their mean rank.
  std::vector<double> mean_ranks{};
};

/// Tests if k conditions differ. `rows`: participants by conditions, row after row, each of k values; NaN =
/// missing. Refused: fewer than two conditions or complete participants, infinite values, all rows tied.
/// std::invalid_argument when the values do not fill whole rows or k < 1.
Result<Friedman> friedman_test(std::span<const double> rows, int k);

}  // namespace stats
