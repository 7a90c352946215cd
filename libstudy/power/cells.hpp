#pragma once
/// A power calculation in parts that can run separately, on many cores or machines.

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

}  // namespace study
