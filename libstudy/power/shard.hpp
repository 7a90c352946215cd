#pragma once
/// The cells of a power calculation and the whole calculation from their shards (analysis/shards.hpp).
///
/// JSON: "schema" is vip-power-shard/1; "studies" is studies_json(); "outcomes" is one of two lists:
/// - Task 1 and 2: for each hypothesis of each world [[supported, any, any_false, paper], tests], the counts
///   of HypothesisCount (studies.hpp). A test has the counts of TestCount (studies.hpp): [holds, uncorrected,
///   against, refused, estimates, estimate_units, participants_least, participants_most];
/// - pilot: for each study [fitted, interval, a, se, low, high, b, se, low, high], where a and
///   b are the estimates, se their standard errors and low and high the ends of their intervals, all by the
///   jackknife. Reading a written double gives exactly the same value.

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "libstudy/analysis/shards.hpp"
#include "libstudy/power/power_json.hpp"

namespace study {

/// A part of a power calculation: consecutive simulated studies with one number of participants.
struct PowerCell : ListedCell {
  int n = 0;
  StudyRange studies;
};

/// All cells of a request, sorted by n and study. A cell simulates at most 100,000 participants in at most
/// 10,000 studies; at most 5,000 participants if the plan uses the mixed model, which is slower.
std::vector<PowerCell> power_cells(const PowerRequest& request);

/// Outcomes of simulated studies: counts for Task 1 or 2, estimates for a pilot.
using StudyOutcomes = std::variant<TaskCounts, PilotOutcomes>;

/// Simulates `studies` with each number of participants. A study's outcome does not depend on other studies.
StudyOutcomes simulate_studies(const PowerRequest& request, StudyRange studies);
StudyOutcomes simulate_cell(const PowerRequest& request, const PowerCell& cell);

/// The results of all studies of a request as JSON.
Json power_json(const PowerRequest& request, const StudyOutcomes& outcomes);

/// Simulates the cell and writes its file atomically. Does nothing if the file already holds this cell.
/// base::Error if the file has another content; an empty file is replaced.
void run_cell(const PowerRequest& request, const PowerCell& cell, const std::filesystem::path& file);

/// Collects the outcomes of all cells from their files, in any order. A cell that occurs twice counts once.
/// base::Error for a file that is no shard, is damaged, has a newer format or holds other studies.
/// If cells are missing, the base::Error names them.
StudyOutcomes join_shards(const PowerRequest& request, const std::vector<std::filesystem::path>& files);

}  // namespace study
