#pragma once
/// Samples without missing values, and their moments to twice double's precision. For the tests in this
/// folder.

#include <cstddef>
#include <span>
#include <vector>

#include "stats/inference/wide.hpp"
#include "stats/result.hpp"

namespace stats {

/// The values that are not missing, all finite, in their order.
struct Sample {
  std::vector<double> values;
  std::size_t n_missing = 0;
};

/// NaN = missing. Refused: an infinite value.
Result<Sample> present(std::span<const double> values);

struct PairedSample {
  std::vector<double> x, y;
  std::size_t n_missing = 0;  ///< pairs that lack a side
};

/// std::invalid_argument when the lengths differ. Refused: an infinite value in a pair that has both sides.
Result<PairedSample> present_pairs(std::span<const double> x, std::span<const double> y);

/// The exponent for which value * 2^-exponent brings the largest magnitude to [0.5, 1); 0 if all are zero.
int common_exponent(std::span<const double> a, std::span<const double> b = {});

/// value * 2^-exponent, exact.
std::vector<Wide> scaled(std::span<const double> values, int exponent);

/// Mean, and sum of squared deviations from it.
struct Moments {
  std::size_t n = 0;
  Wide mean, squares;
  /// Divisor n - 1; 0 for one value.
  double variance() const { return n > 1 ? (squares / static_cast<double>(n - 1)).value() : 0; }
};

Moments moments(std::span<const Wide> values);

/// Sum of (x - mean x)(y - mean y).
Wide cross_squares(std::span<const Wide> x, const Moments& of_x, std::span<const Wide> y,
                   const Moments& of_y);

}  // namespace stats
