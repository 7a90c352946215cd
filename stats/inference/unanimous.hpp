#pragma once
/// An exact test for values that are all equal, which have no spread and so no t.

#include <cstddef>
#include <optional>
#include <span>

#include "stats/inference/distributions.hpp"
#include "stats/inference/exact_mean.hpp"

namespace stats {

struct Unanimous {
  double value = 0;   ///< the common value
  std::size_t n = 0;  ///< number of values, two or more

  /// Exact sign test of the value against `null`. For equal values it is the permutation test that flips the
  /// sign of each deviation: one-sided, p is 2^-n for the side on which all deviations lie and 1 for the
  /// other side; two-sided, 2^(1 - n). p is 1 if the values equal `null`.
  double p(Alternative alternative, double null = 0) const;
};

/// The common value of all values, and their number. Empty if two values differ, or if there are fewer than
/// two. NaN = missing.
std::optional<Unanimous> unanimous(std::span<const double> values);
std::optional<Unanimous> unanimous(const ExactDifferences& differences);

}  // namespace stats
