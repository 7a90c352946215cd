#pragma once
/// Shapiro-Wilk test of normality.

#include <cstddef>
#include <span>

#include "stats/result.hpp"

namespace stats {

struct ShapiroWilk {
  double w = 0;  ///< in (0, 1]; 1 means a straight normal plot
  double p = 0;
  std::size_t n = 0, n_missing = 0;
};

/// Shapiro and Wilk's W, with weights and p-value after Royston (1995, AS R94). NaN = missing. Refused: fewer
/// than 3 or more than 5000 values (the range of the approximation), all values equal, an infinite value.
Result<ShapiroWilk> shapiro_wilk(std::span<const double> values);

}  // namespace stats
