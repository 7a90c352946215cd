#pragma once
/// Task 1's part of the results (docs/report.md).

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/task1_results.hpp"

namespace study {

Json task1_json(const TaskData& data, const Task1Results& results, const stats::AnalysisPlan& plan);
/// One signed-rank test, without p values corrected for multiple tests.
Json signed_rank_json(const stats::SignedRank& test);

}  // namespace study
