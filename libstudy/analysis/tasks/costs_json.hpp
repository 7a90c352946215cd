#pragma once
/// Time per frame and error of each stimulus, beside the answers to it (docs/report.md: costs, sweep).

#include <string>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "libstudy/sweep/setting_price.hpp"

namespace study {

/// A list with one entry for each scene, n_* and method that was shown; empty for a pilot. `sweep`: tables of
/// an accuracy sweep, or null.
Json costs_json(const TaskData& data, const SweepTables* sweep);

/// The entry "sweep": the sweep file's name for display, the heading of each error column, and the reasons
/// why cells of the sweep are in no table.
Json sweep_json(const std::string& file, const SweepTables& sweep);

}  // namespace study
