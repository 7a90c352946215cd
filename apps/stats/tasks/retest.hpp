#pragma once
/// How alike repeated showings were answered.

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// Task 1: a list, one entry for each question that repeated showings were asked; empty without any.
Json rating_retest_json(const TaskData& data);
/// Task 2: pairs and the share of equal choices; null without any.
Json choice_retest_json(const TaskData& data);

}  // namespace apps
