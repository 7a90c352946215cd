#pragma once
/// Prints the fit of a pilot on the console.

#include "apps/stats/ptpe/pilot_fit.hpp"

namespace apps {

void print_fit(const PilotFit& fit);

}  // namespace apps
