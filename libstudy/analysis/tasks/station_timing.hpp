#pragma once
/// The timing of the showings by station, so that a station whose computer or display is slow stands out.

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// A list with an entry for each station (TaskSession::station) that showed a stimulus, by name; empty if all
/// showings are of one station (docs/report.md: timing_stations). Counts the showings of timing_json().
Json station_timing_json(const TaskData& data);

}  // namespace study
