#pragma once
/// "factors" of a task's results: what each level of each factor is worth, where effects are a factor.

#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"

namespace apps {

/// Task 2. Empty: effects are no factor.
Json preference_factors_json(const TaskData& data, const stats::AnalysisPlan& plan);
/// Task 1, of every score.
Json score_factors_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                        const stats::AnalysisPlan& plan);

}  // namespace apps
