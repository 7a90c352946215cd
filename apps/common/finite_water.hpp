#pragma once
/// Water that broke is never taken for a result.

#include <string>

#include "libsim/simulation.hpp"

namespace apps {

/// base::Error naming `place` when a particle was not finite or far outside the tank since the run began,
/// or a figure is not finite now.
void check_finite(sim::Simulation& fluid, const std::string& place);

}  // namespace apps
