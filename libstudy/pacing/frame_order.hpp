#pragma once
/// The order in which the frame rates of a schedule are shown. The order changes their lag-1 correlation, but
/// not their mean and standard deviation.

#include <cstdint>
#include <span>
#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// Lag-1 autocorrelation: sum of products of neighbouring deviations from the mean over the sum of squares.
/// 0 for fewer than two values or for equal values.
double lag1(std::span<const double> values);

/// The values in the order that the rules specify; equal seeds give equal orders. white: a uniform shuffle.
/// ar1: the ranks of a Gaussian AR(1) sequence, whose coefficient is tuned to bring the lag-1 autocorrelation
/// of the ordered values as near to rules.ar1 as possible. trace: the ranks of the trace's rates, which are
/// repeated or cut to the number of values; ascending without a trace. Ties are ranked at random.
std::vector<double> ordered(std::vector<double> values, const PacingRules& rules, std::uint64_t seed);

}  // namespace study
