#pragma once
/// A power calculation in parts that may run apart: on many cores, or on many machines.

#include <string>
#include <variant>
#include <vector>

#include "apps/stats/power/power_json.hpp"

namespace apps {

/// Some studies with one number of participants.
struct PowerCell {
  std::string key;  ///< 16 hexadecimal digits of all that its outcome depends on
  int n = 0;
  StudyRange studies;
};

/// "26 participants, studies 1 to 192".
std::string to_text(const PowerCell& cell);

/// All of a request, by n and study. A cell has about 100,000 participants, all its studies together, and no
/// more than 10,000 studies; 5,000 participants where the plan fits the mixed model, which takes an order of
/// magnitude longer. So no cell takes more than minutes.
std::vector<PowerCell> power_cells(const PowerRequest& request);

/// What simulated studies gave: of Task 1 or 2, or of the pilot.
using StudyOutcomes = std::variant<TaskCounts, PilotOutcomes>;

/// With each number of participants; the same whichever process simulates them, and beside which others.
StudyOutcomes simulate_studies(const PowerRequest& request, StudyRange studies);
StudyOutcomes simulate_cell(const PowerRequest& request, const PowerCell& cell);

/// Of a request's studies, all of them.
Json power_json(const PowerRequest& request, const StudyOutcomes& outcomes);

}  // namespace apps
