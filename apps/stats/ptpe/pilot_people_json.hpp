#pragma once
/// How the participants of a pilot used the scale: as JSON and in sentences.

#include <string>
#include <vector>

#include "apps/stats/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// "raters": reverse coders, drift and lapses, each with its test, the plan's rule and a text. Of all people
/// and no single one: a withdrawal does not reach the file of a fit.
base::Json raters_json(const PilotFit& fit);
/// Codes of the reverse coders with their slopes, for the console alone.
std::vector<std::string> reverse_coders(const PilotFit& fit);
/// Of those that were found, with what the plan makes of them.
std::vector<FitFlag> rater_flags(const PilotFit& fit);

}  // namespace apps
