#pragma once
/// Finds the setting with the smallest error whose frames take no longer than a time budget.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/sweep/price_list.hpp"

namespace study {

/// Reads milliseconds from a text like "11.1ms". base::Error, with place --budget, for another form.
double parse_budget(const std::string& words);
/// Names of the errors in SweepError's order: "front", "centre" and so on, that is, the column names without
/// their unit.
const std::vector<std::string>& sweep_error_names();
/// The error of this name, which must be one of sweep_error_names().
SweepError parse_sweep_error(const std::string& word);

/// Indices of the settings whose 95th percentile of frame times is within the budget, in the order in which
/// to try them. At each step the candidates are the remaining setting with the smallest error and all
/// settings whose range of errors overlaps with its range; the fastest candidate comes next.
std::vector<std::size_t> within_budget(const std::vector<SettingResult>& settings, double budget_ms,
                                       SweepError error);

struct BudgetRequest {
  SweepPlan plan;
  double budget_ms = 0;
  SweepError error = SweepError::Centre;
  double tank_length_m = 0;
  // If set, only settings with this method, n_* or frame rate are considered.
  std::optional<sim::MethodKind> method = {};
  std::optional<std::int64_t> n_star = {};
  std::optional<double> frames_per_s = {};
};

/// Chooses a setting within the budget. Runs the settings of within_budget() in turn, each from two new
/// starts, and returns the first whose 95th percentile of the new frame times is within the budget too. The
/// error in the returned file is over all starts, its times are over the new starts only. Calls `said` with a
/// text for each setting whose new times exceed the budget. base::Error if the sweep has no setting as
/// requested, or none with the requested error. base::Error also if every setting exceeds the budget; this
/// error names the setting that exceeds it least, and by how much.
sim::SettingFile choose_setting(const std::vector<StoredCell>& cells, const SweepOrigin& origin,
                                const BudgetRequest& request,
                                const std::function<StoredCell(const SweepCell&)>& run,
                                const std::function<void(const std::string&)>& said);

}  // namespace study
