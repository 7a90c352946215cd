#pragma once
/// Tests the hypotheses again under other rules, to show if a verdict depends on exclusions, on sessions
/// without tracked gaze, or on averaging the several answers of one participant.

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// The list "sensitivity" of one task (docs/report.md). `planned`: the hypotheses as tested on `data` by the
/// plan.
Json sensitivity_json(const TaskStudy& study, const TaskSelection& selection, const TaskData& data,
                      const std::vector<stats::Hypothesis>& planned);

}  // namespace study
