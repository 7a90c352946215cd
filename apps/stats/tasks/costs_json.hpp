#pragma once
/// What the frames of each method cost, what error they carried, and what people said of them
/// (docs/results.md: costs, sweep).

#include <string>

#include "apps/common/sweep/setting_price.hpp"
#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// A list, one entry for each scene, n_* and method that was shown. `sweep`: null = none was given.
Json costs_json(const TaskData& data, const SweepTables* sweep);

/// "sweep": the file's name to show, the errors' headings by name, and why cells of it stand in no table.
Json sweep_json(const std::string& file, const SweepTables& sweep);

}  // namespace apps
