#pragma once
/// Prints the fit of a pilot on the console.

#include "libstudy/analysis/ptpe/pilot_fit.hpp"

namespace apps {

void print_fit(const study::PilotFit& fit);

}  // namespace apps
