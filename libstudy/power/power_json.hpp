#pragma once
/// Writes the results of a power calculation as JSON (schema "vip-power/1", docs/statistics.md) and as a CSV
/// table. Figures and printed tables are made from the JSON.

#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/power/pilot_power.hpp"
#include "libstudy/power/task_power.hpp"

namespace study {

/// Everything that the outcome of a simulated study depends on except its number and n: program, protocol,
/// plan, worlds, settings.
Json studies_json(const PowerRequest& request);

Json power_json(const PowerRequest& request, const std::vector<WorldPower>& worlds);
Json power_json(const PowerRequest& request, const PilotPower& pilot);

/// CSV with one line for each n and each value that has a standard error, and one for each n and each
/// "closed_form" (power by a formula) and "mean_estimate".
std::string power_csv(const Json& json);

}  // namespace study
