#pragma once
/// The list "factors" of a task's results: comparisons of each two levels of the factors "effects" and
/// "method".

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"

namespace study {

/// Task 2: preference between two levels of a factor. Empty if effects are not a factor.
Json preference_factors_json(const TaskData& data, const stats::AnalysisPlan& plan);
/// Task 1: difference of each score between two levels of a factor. Empty if effects are not a factor.
Json score_factors_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                        const stats::AnalysisPlan& plan);

}  // namespace study
