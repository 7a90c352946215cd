#pragma once
/// "factors" of a task's results: the effect of each level of each factor, if effects are a factor.

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"

namespace study {

/// For Task 2. Empty if effects are not a factor.
Json preference_factors_json(const TaskData& data, const stats::AnalysisPlan& plan);
/// For every score of Task 1.
Json score_factors_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                        const stats::AnalysisPlan& plan);

}  // namespace study
