#pragma once
/// Prints the curve that vip-stats fit-ptpe fitted to the ratings of a pilot study, on the console.

#include "libstudy/analysis/ptpe/pilot_fit.hpp"

namespace apps {

void print_fit(const study::PilotFit& fit);

}  // namespace apps
