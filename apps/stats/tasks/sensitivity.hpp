#pragma once
/// The hypotheses tested again under other rules, to show if verdicts depend on an exclusion.

#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace apps {

/// "sensitivity" of one task (docs/report.md); `planned`: the verdicts of `data`.
Json sensitivity_json(const study::TaskStudy& study, const TaskSelection& selection, const TaskData& data,
                      const std::vector<stats::Hypothesis>& planned);

}  // namespace apps
