#pragma once
/// Descriptive statistics of the answers, by question and cell, for any protocol (docs/report.md:
/// descriptives).

#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// A list with an entry for each of these questions (ids) and each cell with answers to it, over the analysed
/// trials.
Json descriptives_json(const TaskData& data, const std::vector<std::string>& questions);

}  // namespace study
