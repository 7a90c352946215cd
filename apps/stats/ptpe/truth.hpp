#pragma once
/// Whether a fit recovers what simulated participants were made with.

#include <string>

#include "apps/stats/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace apps {

/// Does each interval of the main estimate hold its true value?
struct Recovery {
  stats::PtpeModel truth;
  bool a_held = false, b_held = false;
};

/// a and b of an observer, spelt as for vip-study run: "ptpe:a=24,b=0.02". base::Error otherwise.
stats::PtpeModel parse_truth(const std::string& observer);

/// base::Error where the fit's level is not the middle of the scale, at which an observer's curve runs.
void check_comparable(const PilotFit& fit, const std::string& observer);

/// `fit` is ok().
Recovery check_recovery(const PilotFit& fit, const stats::PtpeModel& truth);

/// Two lines for people, and the same for fit.json.
std::string format_recovery(const PilotFit& fit, const Recovery& recovery);
base::Json recovery_json(const Recovery& recovery);

}  // namespace apps
