#pragma once
/// Task 2's part of the results (docs/report.md).

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"
#include "stats/analysis/task2.hpp"

namespace apps {

Json task2_json(const TaskData& data, const stats::PreferenceAnalysis& analysis,
                const stats::AnalysisPlan& plan);

}  // namespace apps
