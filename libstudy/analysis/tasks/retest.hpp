#pragma once
/// Agreement of the answers to repeated showings.

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// Task 1: a list with one entry for each question asked about repeated showings; empty without repeats.
Json rating_retest_json(const TaskData& data);
/// Task 2: number of pairs and share of equal choices; null without repeats.
Json choice_retest_json(const TaskData& data);

}  // namespace study
