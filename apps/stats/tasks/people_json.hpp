#pragma once
/// "people" of the results: who took part, in summaries by which no single person is recognised.

#include <string>
#include <utility>
#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// Fewer people than this are shown as no group of their own.
inline constexpr int smallest_group = 3;
/// Mean, SD and range of fewer numbers than this are not shown: they nearly give the numbers themselves.
inline constexpr int fewest_numbers = 5;

/// Answers and how many people gave each; `pooled`: answers of fewer than smallest_group people, taken
/// together with the next smallest groups until they are that many, so that no small group follows from the
/// sum.
struct GroupCounts {
  std::vector<std::pair<std::string, int>> shown;  ///< in the order given
  std::vector<std::string> pooled;
  int pooled_people = 0;
};
GroupCounts pool_small_groups(std::vector<std::pair<std::string, int>> counts);

/// One entry for each part of the study that asks its participants about themselves; of those analysed.
/// `answers`: TaskStudy::about_people.
Json people_json(const std::vector<const TaskData*>& parts, const std::vector<study::PersonalEntry>& answers);

}  // namespace apps
