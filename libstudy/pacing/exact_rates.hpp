#pragma once
/// The distribution behind a schedule: rates with exact moments, before they are put in order.

#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// Smallest standard deviation other than 0 that a design may ask for, frames/s: intervals are whole
/// nanoseconds.
inline constexpr double least_sd_fps = 1e-3;

/// N = frame_count(setting) instantaneous rates, frames/s, ascending: stratified quantiles of a truncated
/// normal on [fps_min, fps_max] with the wished mean (harmonic or arithmetic, as the rules say) and
/// population standard deviation to 1e-9 relative. base::Error naming the setting, with the nearest moments
/// there are, when none has them.
std::vector<double> exact_rates(const FpsSetting& setting, const PacingRules& rules);

/// The mean of rates that the rules count by.
double mean_rate(const std::vector<double>& rates, FpsMean mean);

}  // namespace study
