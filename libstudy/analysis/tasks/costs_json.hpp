#pragma once
/// The cost and error of each method's frames, and people's answers about them (docs/report.md: costs,
/// sweep).

#include <string>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "libstudy/sweep/setting_price.hpp"

namespace study {

/// A list with one entry for each scene, n_* and method shown. `sweep`: null if none was given.
Json costs_json(const TaskData& data, const SweepTables* sweep);

/// "sweep": the file's name for display, the errors' headings by name, and why cells of the sweep are in no
/// table.
Json sweep_json(const std::string& file, const SweepTables& sweep);

}  // namespace study
