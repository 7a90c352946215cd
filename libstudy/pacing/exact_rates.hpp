#pragma once
/// The frame rates of a schedule with exact mean and standard deviation, in ascending order. ordered()
/// (frame_order.hpp) then puts them in the order in which they are shown.

#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// Smallest standard deviation other than 0 that a design may have, frames/s. Smaller ones are lost when
/// intervals are rounded to whole nanoseconds.
inline constexpr double least_sd_fps = 1e-3;

/// N = frame_count(setting) instantaneous rates, frames/s, ascending: stratified quantiles of a truncated
/// normal, with the requested mean (harmonic or arithmetic, as the rules specify) and population standard
/// deviation to 1e-9 relative. The normal is truncated below at the larger of fps_min and 1000 /
/// max_interval_ms, and above at fps_max, if any. If the standard deviation is 0, all rates equal the mean.
/// base::Error naming the setting if there is no solution.
std::vector<double> exact_rates(const FpsSetting& setting, const PacingRules& rules);

/// The harmonic or arithmetic mean of the rates, frames/s.
double mean_rate(const std::vector<double>& rates, FpsMean mean);

}  // namespace study
