#pragma once
/// Answers as they were given, by question and cell: of any protocol (docs/results.md: descriptives).

#include <string>
#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// A list with an entry for each of these questions (ids) and each cell in which it was answered, over the
/// trials that are analysed.
Json descriptives_json(const TaskData& data, const std::vector<std::string>& questions);

}  // namespace apps
