#pragma once
/// The fit of a pilot for people, on the console.

#include "apps/stats/ptpe/pilot_fit.hpp"

namespace apps {

void print_fit(const PilotFit& fit);

}  // namespace apps
