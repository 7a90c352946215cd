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
  /// sign of each deviation: 2^-n on the side where all of them lie, 1 on the other; 1 if they equal `null`.
  double p(Alternative alternative, double null = 0) const;
};

/// Empty if two values differ, or if there are fewer than two. NaN = missing.
std::optional<Unanimous> unanimous(std::span<const double> values);
std::optional<Unanimous> unanimous(const ExactDifferences& differences);

}  // namespace stats
