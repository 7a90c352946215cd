#pragma once
/// The entry "people" of the results: summaries of the participants' answers about themselves. They do not
/// reveal the answer of a single person.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// Smallest number of people with the same answer whose count is shown separately.
inline constexpr int smallest_group = 3;
/// Fewest numeric answers for which mean, SD and range are shown. With fewer answers, mean, SD and range
/// would nearly reveal the answers.
inline constexpr int fewest_numbers = 5;

/// Answers and the number of people who gave each. Answers of fewer than smallest_group people are pooled.
/// The next smallest groups are pooled with them until pooled_people is at least smallest_group. So the count
/// of a small group cannot be derived from the total.
struct GroupCounts {
  /// Answers that are not pooled, with their counts, in the order given; without answers of count 0.
  std::vector<std::pair<std::string, int>> shown;
  std::vector<std::string> pooled;  ///< the pooled answers
  int pooled_people = 0;            ///< number of people who gave one of the pooled answers
};
GroupCounts pool_small_groups(std::vector<std::pair<std::string, int>> counts);

/// One entry for each of `parts` that asks participants about themselves and has analysed participants. Only
/// analysed participants are counted. `answers`: answers of all participants about themselves, from
/// TaskStudy::about_people.
Json people_json(const std::vector<const TaskData*>& parts, const std::vector<PersonalEntry>& answers);

}  // namespace study
