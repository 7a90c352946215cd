#pragma once
/// The hypotheses tested again under other rules, to show if verdicts depend on an exclusion.

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// "sensitivity" of one task (docs/report.md); `planned`: the verdicts of `data`.
Json sensitivity_json(const TaskStudy& study, const TaskSelection& selection, const TaskData& data,
                      const std::vector<stats::Hypothesis>& planned);

}  // namespace study
