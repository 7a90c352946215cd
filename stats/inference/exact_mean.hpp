#pragma once
/// Means of whole numbers, kept as sum and count. Their differences are compared over a common denominator,
/// so that equal ones tie: 1 - 2/3 and 4/3 - 1 are equal, and as doubles they are not.

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// value() is the double nearest to the mean, so that equal means are equal doubles; what takes ranks of
/// means themselves (Friedman, Mann and Whitney) may take those.
struct ExactMean {
  double sum = std::numeric_limits<double>::quiet_NaN();  ///< NaN: missing
  int count = 1;                                          ///< > 0

  double value() const { return sum / count; }
};

/// Differences as numerators over one denominator: whole numbers where the sums are whole. Sums that are not
/// are taken as the doubles they are.
struct ExactDifferences {
  std::vector<double> numerators;
  double denominator = 1;
  std::size_t n_missing = 0;  ///< pairs without one of the two

  std::vector<double> values() const;  ///< each the double nearest to the difference
};

/// x - y, pair by pair. std::invalid_argument unless of equal length with counts above 0. Refused: an
/// infinite sum; counts without a common denominator that keeps the numerators below 2^53.
Result<ExactDifferences> exact_differences(std::span<const ExactMean> x, std::span<const ExactMean> y);

}  // namespace stats
