#pragma once
/// Looks up the time and errors of one setting in a sweep file.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/sweep/price_list.hpp"

namespace study {

/// The evaluation of cells with equal machine, program, scene file, run length and picture sizes against one
/// reference.
struct SweepTable {
  SweepPlan plan;
  PriceList list;
};

/// All tables of a sweep file. Cells that are not comparable are in different tables.
struct SweepTables {
  std::vector<SweepTable> tables;
  /// Sentences that say why cells are in no table, for example that the reference is missing or the scene
  /// file has changed.
  std::vector<std::string> left_out;
};
SweepTables sweep_tables(const std::vector<StoredCell>& cells);
/// Evaluates all cells of the sweep file. base::Error if SweepFile cannot open the file.
SweepTables read_sweep_tables(const std::filesystem::path& path);

/// A setting's row in one of the tables. The tables must outlive this object.
struct SettingPrice {
  const SweepTable* sweep = nullptr;
  const SettingResult* row = nullptr;
  const SettingResult* hires = nullptr;  ///< usual setting of HiRes at the same n_*; null: not in the table
};

struct SettingPrices {
  std::vector<SettingPrice> found;  ///< one entry for each table that has a row of the setting
  std::string why_none;             ///< the reason if `found` is empty
};
/// Finds the rows of exactly this setting in the tables of the scene file with this SHA-256; the setting's
/// `scene` is ignored. NaN as a knob's value means that the knob follows the frame rate from frame to frame.
/// No row has such a knob, so nothing is found then.
SettingPrices prices_of(const SweepTables& tables, sim::SolverSetting setting,
                        const std::string& scene_sha256);

/// The errors in words, "centre_pct 0.25 [0.2, 0.3], ...", without those that were not measured.
std::string errors_in_words(const std::array<Spread, sweep_error_count>& errors);
/// Lines of text: time and errors of the row, a comparison of both with HiRes, and machine and reference.
std::vector<std::string> in_words(const SettingPrice& price);
/// Lines of text on all rows found, or the reason why none was found.
std::vector<std::string> in_words(const SettingPrices& prices);

}  // namespace study
