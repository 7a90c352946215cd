#pragma once
/// Values that are all the same have no spread, and so no t. What they say is tested exactly.

#include <cstddef>
#include <optional>
#include <span>

#include "stats/inference/alternative.hpp"
#include "stats/inference/exact_mean.hpp"

namespace stats {

struct Unanimous {
  double value = 0;   ///< which all of them are
  std::size_t n = 0;  ///< two or more

  /// Exact sign test of value against `null`, which for equal values is the permutation test that turns each
  /// sign round: 2^-n on the side where all of them lie, 1 on the other; 1 where they equal `null`.
  double p(Alternative alternative, double null = 0) const;
};

/// Empty when two values differ, or for fewer than two. NaN = missing.
std::optional<Unanimous> unanimous(std::span<const double> values);
std::optional<Unanimous> unanimous(const ExactDifferences& differences);

}  // namespace stats
