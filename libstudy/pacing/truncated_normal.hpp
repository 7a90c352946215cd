#pragma once
/// Stratified quantiles of a truncated normal, exact far into its tails.

#include <cstddef>
#include <vector>

namespace study {

/// The n quantiles at p = (i + 1/2) / n, i = 0 ... n - 1, of a standard normal truncated to [cut, cut +
/// width]. Returns their distances from `cut`, ascending, in standard deviations of the untruncated normal.
/// width may be infinite. The distances have full relative precision also for cut >> 0, where the
/// distribution tends to an exponential, and for width << 1, where it tends to a tilted uniform distribution.
/// n >= 1, cut finite, width > 0.
std::vector<double> truncated_normal_strata(double cut, double width, std::size_t n);

}  // namespace study
