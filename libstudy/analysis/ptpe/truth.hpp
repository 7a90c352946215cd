#pragma once
/// Compares a fit with the parameters of simulated participants.

#include <string>

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

/// True parameters, and for each interval of the main estimate: true if it covers the true value.
struct Recovery {
  stats::PtpeModel truth;
  bool a_held = false, b_held = false;
};

/// Reads a and b of an observer model from the text that `vip-study run --observer` takes, such as
/// "ptpe:a=24,b=0.02". base::Error for any other text.
stats::PtpeModel parse_truth(const std::string& observer);

/// base::Error if the fit's level is not the middle of the scale, which is the level of an observer's curve.
void check_comparable(const PilotFit& fit, const std::string& observer);

/// Checks if the intervals of the fit's main estimate cover the a and b of `truth`. Requires fit.ok().
Recovery check_recovery(const PilotFit& fit, const stats::PtpeModel& truth);

/// Lines for the console: a heading, then for a and for b the interval and whether it covers the true value.
std::string format_recovery(const PilotFit& fit, const Recovery& recovery);
base::Json recovery_json(const Recovery& recovery);

}  // namespace study
