#pragma once
/// Looks up one setting in a sweep file: for programs that run it, and for pages that report on it.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/sweep/price_list.hpp"

namespace study {

/// Cells of one machine, program and scene file, with one length and picture size, compared with one
/// reference.
struct SweepTable {
  SweepPlan plan;
  PriceList list;
};

/// All tables of a sweep file; cells that are not comparable are in different tables.
struct SweepTables {
  std::vector<SweepTable> tables;
  /// Why cells are in no table, a sentence each: no finished reference, a scene file that changed.
  std::vector<std::string> left_out;
};
SweepTables sweep_tables(const std::vector<StoredCell>& cells);
/// base::Error: see SweepFile.
SweepTables read_sweep_tables(const std::filesystem::path& path);

/// A setting's row in one of the tables, which must outlive it.
struct SettingPrice {
  const SweepTable* sweep = nullptr;
  const SettingResult* row = nullptr;
  const SettingResult* hires = nullptr;  ///< default HiRes at the same n_*; null: not in the table
};

struct SettingPrices {
  std::vector<SettingPrice> found;  ///< one per table that holds the setting
  std::string why_none;             ///< empty if there are some
};
/// Finds exactly this setting for this scene file; the setting's `scene` is ignored. A knob of the setting
/// that is NaN is chosen anew for each frame from the frame rate, so that no row matches.
SettingPrices prices_of(const SweepTables& tables, sim::SolverSetting setting,
                        const std::string& scene_sha256);

/// "centre_pct 0.25 [0.2, 0.3], ..."; omits errors that were not measured.
std::string errors_in_words(const std::array<Spread, sweep_error_count>& errors);
/// Lines with time and errors, and both compared with HiRes if it was measured.
std::vector<std::string> in_words(const SettingPrice& price);
/// The same for all rows found, or why there are none.
std::vector<std::string> in_words(const SettingPrices& prices);

}  // namespace study
