#pragma once
/// Writes hypotheses about methods as JSON for the results (docs/report.md).

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

Json hypothesis_json(const stats::Hypothesis& hypothesis);
/// Verdicts, estimates and p values of the hypothesis alone, for a sensitivity analysis: the hypotheses
/// tested again under other rules.
Json hypothesis_outline_json(const stats::Hypothesis& hypothesis);

}  // namespace study
