#pragma once
/// Quantiles of distributions and of samples.

#include <span>
#include <vector>

namespace stats {

/// p quantile of Student's t with df > 0 degrees of freedom, 0 < p < 1 (std::invalid_argument otherwise).
double student_quantile(double p, double df);
/// p quantile of the standard normal, 0 < p < 1 (std::invalid_argument otherwise).
double normal_quantile(double p);
/// Standard normal distribution function.
double normal_probability(double z);
/// p quantile, 0 <= p <= 1, of values in ascending order, linear between order statistics (Hyndman and Fan
/// 1996, type 7). std::invalid_argument when there are no values or p is outside [0, 1].
double sorted_quantile(std::span<const double> ascending, double p);
/// The median of values in any order; the mean of the two middle ones if their number is even.
/// std::invalid_argument when there are no values.
double median_of(std::vector<double> values);

}  // namespace stats
