#pragma once
/// Means with confidence intervals, of values and of paired differences.

#include <cstddef>
#include <span>
#include <vector>

namespace stats {

/// A mean with its Student's t interval.
struct MeanInterval {
  double mean = 0;           ///< NaN without values
  double low = 0, high = 0;  ///< NaN with fewer than two values
  std::size_t n = 0;
};

/// The mean of n independent values with its interval mean -+ t s / sqrt(n), where t is Student's quantile
/// with n - 1 degrees of freedom and s the sample's standard deviation. std::invalid_argument unless all
/// values are finite and confidence lies in (0, 1).
MeanInterval mean_interval(std::span<const double> values, double confidence = 0.95);

/// Mean of each group of `size` consecutive values. A group holds the repeats of one measurement; repeats are
/// not independent, so a group counts as one value. Values that are not finite are left out; a group with no
/// finite value is omitted. std::invalid_argument unless the values fill whole groups.
std::vector<double> group_means(std::span<const double> values, std::size_t size);

/// group_means of a[i] - b[i]; a pair counts where both are finite. std::invalid_argument when the lengths
/// differ.
std::vector<double> paired_group_means(std::span<const double> a, std::span<const double> b,
                                       std::size_t size);

}  // namespace stats
