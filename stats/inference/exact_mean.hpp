#pragma once
/// Means of whole numbers, stored as sum and count. Their differences are compared over a common denominator,
/// so that equal differences tie: 1 - 2/3 and 4/3 - 1 are equal, but their doubles differ.

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// value() is the double nearest to the mean, so equal means are equal doubles. Ranks of the means themselves
/// (as in Friedman's test) can use value().
struct ExactMean {
  double sum = std::numeric_limits<double>::quiet_NaN();  ///< NaN: missing
  int count = 1;                                          ///< > 0

  double value() const { return sum / count; }
};

/// Differences as numerators over one denominator; the numerators are whole if the sums are. With other sums
/// the numerators are rounded to double.
struct ExactDifferences {
  std::vector<double> numerators;
  double denominator = 1;
  std::size_t n_missing = 0;  ///< pairs that lack a value

  std::vector<double> values() const;  ///< the differences, each rounded to the nearest double
};

/// x - y, pair by pair. std::invalid_argument unless the lengths are equal and the counts above 0. Refused:
/// an infinite sum; counts whose common denominator is so large that numerators could exceed 2^53.
Result<ExactDifferences> exact_differences(std::span<const ExactMean> x, std::span<const ExactMean> y);

}  // namespace stats
