#pragma once
/// The file of one cell of a power calculation, and the whole calculation from such files.
///
/// JSON: "schema" is vip-power-shard/1, "key" the cell's, "cell" its words, "studies" what they depend on
/// (studies_json), "outcomes" one of two lists:
/// - Task 1 and 2, an entry for each hypothesis of each world: [[supported, any, any_false, paper], tests],
/// each test
///   [holds, uncorrected, against, refused, estimates, estimate_units, participants_least,
///   participants_most];
/// - pilot, an entry for each study: [fitted, interval, a, se, low, high, b, se, low, high], all but the
/// first two of
///   the jackknife's interval; doubles are written so that they are read back bit for bit.

#include <filesystem>
#include <vector>

#include "apps/stats/power/cells.hpp"

namespace apps {

/// Simulates the cell and writes its file at once; nothing where the file is there and holds this cell.
/// base::Error where another file stands there.
void run_cell(const PowerRequest& request, const PowerCell& cell, const std::filesystem::path& file);

/// Of files in any order; a cell that is there twice counts once. base::Error for a file that is none, that
/// is damaged, newer, or of other studies, and where cells are missing, which it names.
StudyOutcomes join_shards(const PowerRequest& request, const std::vector<std::filesystem::path>& files);

}  // namespace apps
