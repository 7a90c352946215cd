#pragma once
/// Stratified quantiles of a truncated normal, exact far into its tails.

#include <cstddef>
#include <vector>

namespace study {

/// The n quantiles at p = (i + 1/2) / n, ascending, of a standard normal truncated to [cut, cut + width],
/// given as distances from `cut`, in standard deviations of the parent normal. width may be infinite.
/// cut >> 0 tends to an exponential distribution, width << 1 to a tilted uniform one: both ends keep full
/// relative precision. n >= 1, cut finite, width > 0.
std::vector<double> truncated_normal_strata(double cut, double width, std::size_t n);

}  // namespace study
