#pragma once
/// What a sweep file says of one setting: for programs that run it, and for pages that report on it.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/sweep/price_list.hpp"

namespace apps {

/// Cells of one machine, program and scene file, of one length and picture, held against one reference.
struct SweepTable {
  SweepPlan plan;
  PriceList list;
};

/// All that a sweep file holds, never mixed.
struct SweepTables {
  std::vector<SweepTable> tables;
  /// Why cells stand in no table, a sentence each: no finished reference, a scene file that changed.
  std::vector<std::string> left_out;
};
SweepTables sweep_tables(const std::vector<StoredCell>& cells);
/// base::Error: see SweepFile.
SweepTables read_sweep_tables(const std::filesystem::path& path);

/// A setting's row in one of the tables, which outlive it.
struct SettingPrice {
  const SweepTable* sweep = nullptr;
  const SettingResult* row = nullptr;
  const SettingResult* hires = nullptr;  ///< HiRes as usual at the same n_*; null: not in the table
};

struct SettingPrices {
  std::vector<SettingPrice> found;  ///< one for each table that holds the setting
  std::string why_none;             ///< empty: there are some
};
/// Of exactly this setting in this scene file; its `scene` is not looked at. A knob that is NaN follows the
/// frame rate and equals no row's.
SettingPrices prices_of(const SweepTables& tables, SolverSetting setting, const std::string& scene_sha256);

/// "centre_pct 0.25 [0.2, 0.3], ..."; errors that were not measured are left out.
std::string errors_in_words(const std::array<Spread, sweep_error_count>& errors);
/// Lines: time and errors, the same against HiRes, where it was measured.
std::vector<std::string> in_words(const SettingPrice& price);
/// The same of all that was found, or why there is nothing.
std::vector<std::string> in_words(const SettingPrices& prices);

}  // namespace apps
