#pragma once
/// The setting of least error whose frames keep a budget of time.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/setting_file.hpp"
#include "apps/common/sweep/price_list.hpp"

namespace apps {

/// Milliseconds from "11.1ms". base::Error that names --budget.
double parse_budget(const std::string& words);
/// "front", "centre" and so on, in SweepError's order: columns without their unit.
const std::vector<std::string>& sweep_error_names();
/// Of one of these names.
SweepError parse_sweep_error(const std::string& word);

/// Settings whose 95th percentile is within the budget, in the order in which to try them: the least error
/// first; of those whose error's range meets the least one's range, the cheapest. Places in `settings`.
std::vector<std::size_t> within_budget(const std::vector<SettingResult>& settings, double budget_ms,
                                       SweepError error);

struct BudgetWish {
  SweepPlan plan;
  double budget_ms = 0;
  SweepError error = SweepError::Centre;
  double tank_length_m = 0;
  // Only settings of these, where they are given.
  std::optional<sim::MethodKind> method = {};
  std::optional<std::int64_t> n_star = {};
  std::optional<double> frames_per_s = {};
};

/// Tries the settings of `cells` that keep the budget: each is run from two fresh starts, and the first that
/// keeps it again is the choice. Its error is over all starts, its milliseconds are of the fresh ones.
/// `said` hears of each that is tried and does not. base::Error where none keeps the budget: what comes
/// nearest, and what it lacks.
SettingFile choose_setting(const std::vector<StoredCell>& cells, const SweepOrigin& origin,
                           const BudgetWish& wish, const std::function<StoredCell(const SweepCell&)>& run,
                           const std::function<void(const std::string&)>& said);

}  // namespace apps
