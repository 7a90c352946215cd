#pragma once
/// The file of one cell of a power calculation, and the whole calculation from such files.
///
/// JSON: "schema" is vip-power-shard/1; "key" and "cell" are the cell's key and its name in words; "studies"
/// is studies_json(); "outcomes" is one of two lists:
/// - Task 1 and 2: for each hypothesis of each world [[supported, any, any_false, paper], tests], where a
///   test is [holds, uncorrected, against, refused, estimates, estimate_units, participants_least,
///   participants_most];
/// - pilot: for each study [fitted, interval, a, se, low, high, b, se, low, high], where all but the first
///   two are of the jackknife's interval. Doubles are written so that they are read back exactly.

#include <filesystem>
#include <vector>

#include "libstudy/power/cells.hpp"

namespace study {

/// Simulates the cell and writes its file atomically. Does nothing if the file exists and holds this cell.
/// base::Error if another file exists there.
void run_cell(const PowerRequest& request, const PowerCell& cell, const std::filesystem::path& file);

/// Joins files in any order; a cell that occurs twice counts once. base::Error for a file that is not a
/// shard, is damaged, newer, or of other studies, and if cells are missing, which it names.
StudyOutcomes join_shards(const PowerRequest& request, const std::vector<std::filesystem::path>& files);

}  // namespace study
