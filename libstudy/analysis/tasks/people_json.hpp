#pragma once
/// "people" of the results: summaries of the participants that do not identify a single person.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// Smallest group of people that is shown separately.
inline constexpr int smallest_group = 3;
/// Fewest numbers for which mean, SD and range are shown; fewer would nearly reveal the numbers themselves.
inline constexpr int fewest_numbers = 5;

/// Answers and the number of people who gave each. `pooled`: answers of fewer than smallest_group people,
/// combined with the next smallest groups until they are that many, so that no small group can be derived
/// from the sum.
struct GroupCounts {
  std::vector<std::pair<std::string, int>> shown;  ///< in the order given
  std::vector<std::string> pooled;
  int pooled_people = 0;
};
GroupCounts pool_small_groups(std::vector<std::pair<std::string, int>> counts);

/// One entry for each part of the study that asks its participants about themselves, over the analysed ones.
/// `answers`: TaskStudy::about_people.
Json people_json(const std::vector<const TaskData*>& parts, const std::vector<PersonalEntry>& answers);

}  // namespace study
