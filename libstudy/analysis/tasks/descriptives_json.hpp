#pragma once
/// Descriptive statistics of the answers, by question and cell, for any protocol (docs/report.md:
/// descriptives).

#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// A list with one entry for each question in `questions` (ids). An entry's "cells" describe the question's
/// answers in analysed trials.
Json descriptives_json(const TaskData& data, const std::vector<std::string>& questions);

}  // namespace study
