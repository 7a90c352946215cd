#pragma once
/// Equivalence by paired t-tests against margins (Schuirmann 1987; Lakens 2017). A pair with a NaN is
/// dropped. Refused: fewer than two pairs, an infinite value, differences that are constant up to rounding, a
/// t beyond the range of double. std::invalid_argument if x and y differ in length.

#include <array>
#include <cstddef>
#include <span>

#include "stats/result.hpp"

namespace stats {

/// Differences inside (low, high) count as equivalent; in the data's unit. std::invalid_argument unless both
/// are finite and low < high.
struct Margins {
  double low = -0.5, high = 0.5;
};

/// Two one-sided tests: `t_lower` against "estimate <= low", `t_upper` against "estimate >= high".
struct EquivalenceTest {
  double estimate = 0, stderr_estimate = 0, df = 0;
  double t_lower = 0, p_lower = 0;
  double t_upper = 0, p_upper = 0;
  double p = 0;  ///< the larger of p_lower and p_upper: equivalence is shown if p < alpha
  /// interval of confidence 1 - 2 alpha; it lies inside the margins if equivalence is shown
  std::array<double, 2> ci{};
  std::size_t n = 0;  ///< number of pairs
  std::size_t n_missing = 0;
};

/// Tests that the mean of x - y over pairs lies within the margins. alpha in (0, 1/2)
/// (std::invalid_argument).
Result<EquivalenceTest> equivalence_paired(std::span<const double> x, std::span<const double> y,
                                           Margins margins, double alpha = 0.05);

}  // namespace stats
