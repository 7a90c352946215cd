#pragma once
/// Finds the setting with the smallest error whose frames keep a time budget.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/sweep/price_list.hpp"

namespace study {

/// Parses milliseconds from "11.1ms". base::Error that names --budget.
double parse_budget(const std::string& words);
/// "front", "centre" and so on, in SweepError's order: columns without their unit.
const std::vector<std::string>& sweep_error_names();
/// `word` must be one of these names.
SweepError parse_sweep_error(const std::string& word);

/// Settings whose 95th percentile is within the budget, as indices in `settings`, in the order in which to
/// try them: smallest error first, but the cheapest among those whose error range overlaps that of the
/// smallest.
std::vector<std::size_t> within_budget(const std::vector<SettingResult>& settings, double budget_ms,
                                       SweepError error);

struct BudgetRequest {
  SweepPlan plan;
  double budget_ms = 0;
  SweepError error = SweepError::Centre;
  double tank_length_m = 0;
  // Only settings with these values, if given.
  std::optional<sim::MethodKind> method = {};
  std::optional<std::int64_t> n_star = {};
  std::optional<double> frames_per_s = {};
};

/// Tries the settings of `cells` that keep the budget: runs each from two fresh starts and chooses the first
/// that keeps it again. Its error is over all starts, its milliseconds over the fresh ones. Calls `said` for
/// each setting that fails when tried. base::Error if none keeps the budget, with the nearest one and how
/// much it misses.
sim::SettingFile choose_setting(const std::vector<StoredCell>& cells, const SweepOrigin& origin,
                                const BudgetRequest& request,
                                const std::function<StoredCell(const SweepCell&)>& run,
                                const std::function<void(const std::string&)>& said);

}  // namespace study
