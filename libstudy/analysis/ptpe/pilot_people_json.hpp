#pragma once
/// How a pilot's participants used the scale, as JSON and in sentences.

#include <string>
#include <vector>

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"

namespace study {

/// "raters": reverse coders, drift and lapses, each with its test, the plan's rule and a text. It covers all
/// people and names no single one, since a withdrawal does not reach the file of a fit.
base::Json raters_json(const PilotFit& fit);
/// Codes of the reverse coders with their slopes, only for the console.
std::vector<std::string> reverse_coders(const PilotFit& fit);
/// Flags for the effects found, with the plan's rule for each.
std::vector<FitFlag> rater_flags(const PilotFit& fit);

}  // namespace study
