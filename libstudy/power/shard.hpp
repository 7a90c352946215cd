#pragma once
/// A power calculation in parts that can run separately, on many cores or machines: its cells, the file of
/// one cell, and the whole calculation from such files.
///
/// JSON: "schema" is vip-power-shard/1; "key" and "cell" are the cell's key and its name in words; "studies"
/// is studies_json(); "outcomes" is one of two lists:
/// - Task 1 and 2: for each hypothesis of each world [[supported, any, any_false, paper], tests], where a
///   test is [holds, uncorrected, against, refused, estimates, estimate_units, participants_least,
///   participants_most];
/// - pilot: for each study [fitted, interval, a, se, low, high, b, se, low, high], where all but the first
///   two are of the jackknife's interval. Doubles are written so that they are read back exactly.

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "libstudy/power/power_json.hpp"

namespace study {

/// Some studies with one number of participants.
struct PowerCell {
  std::string key;  ///< 16 hexadecimal digits, a hash of everything that its outcome depends on
  int n = 0;
  StudyRange studies;
};

/// "26 participants, studies 1 to 192".
std::string to_text(const PowerCell& cell);

/// All cells of a request, by n and study. A cell has about 100,000 participants over all its studies, and at
/// most 10,000 studies; 5,000 participants if the plan fits the mixed model, which is ten times slower. So
/// each cell takes minutes at most.
std::vector<PowerCell> power_cells(const PowerRequest& request);

/// Outcomes of simulated studies: of Task 1 or 2, or of the pilot.
using StudyOutcomes = std::variant<TaskCounts, PilotOutcomes>;

/// Simulates the studies with each number of participants. A study's outcome does not depend on the process
/// or on the other studies.
StudyOutcomes simulate_studies(const PowerRequest& request, StudyRange studies);
StudyOutcomes simulate_cell(const PowerRequest& request, const PowerCell& cell);

/// JSON of all studies of a request.
Json power_json(const PowerRequest& request, const StudyOutcomes& outcomes);

/// Simulates the cell and writes its file atomically. Does nothing if the file exists and holds this cell.
/// base::Error if another file exists there.
void run_cell(const PowerRequest& request, const PowerCell& cell, const std::filesystem::path& file);

/// Joins files in any order; a cell that occurs twice counts once. base::Error for a file that is not a
/// shard, is damaged, newer, or of other studies, and if cells are missing, which it names.
StudyOutcomes join_shards(const PowerRequest& request, const std::vector<std::filesystem::path>& files);

}  // namespace study
