#pragma once
/// Agreement of the answers to repeated showings.

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// Task 1: a list with one entry for each question asked about repeated showings; empty without repeats.
Json rating_retest_json(const TaskData& data);
/// Task 2: number of pairs and share of equal choices; null without repeats.
Json choice_retest_json(const TaskData& data);

}  // namespace apps
