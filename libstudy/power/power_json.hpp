#pragma once
/// The results of a power calculation as JSON ("vip-power/1", docs/statistics.md) and as a table. Figures and
/// printed tables are made from the JSON.

#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/power/pilot_power.hpp"
#include "libstudy/power/task_power.hpp"

namespace study {

/// Everything that simulated studies depend on besides their number and n: program, protocol, plan, worlds,
/// settings.
Json studies_json(const PowerRequest& request);

Json power_json(const PowerRequest& request, const std::vector<WorldPower>& worlds);
Json power_json(const PowerRequest& request, const PilotPower& pilot);

/// One line for each figure and n.
std::string power_csv(const Json& json);

}  // namespace study
