#pragma once
/// Writes hypotheses about methods as JSON for the results (docs/report.md).

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

Json hypothesis_json(const stats::Hypothesis& hypothesis);
/// The hypothesis with only the fields that a sensitivity analysis shows.
Json hypothesis_outline_json(const stats::Hypothesis& hypothesis);

}  // namespace study
