#pragma once
/// Rounds intervals to whole nanoseconds, as stored, and preserves the setting's moments.

#include <cstdint>
#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// Rounds so that deadlines never drift by more than half a nanosecond, then moves single intervals by a
/// nanosecond where that is needed for the mean (relative) and the standard deviation (of max(sd, 1 frame/s))
/// to hold to 1e-6. A constant schedule stays constant. base::Error naming the setting when no such list is
/// found.
std::vector<std::int64_t> whole_nanoseconds(const std::vector<double>& intervals_s, const FpsSetting& setting,
                                            FpsMean mean);

}  // namespace study
