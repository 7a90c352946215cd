#pragma once
/// Task 2's part of the results (docs/report.md).

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/task2.hpp"

namespace study {

Json task2_json(const TaskData& data, const stats::PreferenceAnalysis& analysis,
                const stats::AnalysisPlan& plan);

}  // namespace study
