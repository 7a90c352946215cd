#pragma once
/// Rejects the results of a simulation that became unstable.

#include <string>

#include "libsim/simulation.hpp"

namespace sim {

/// Throws base::Error naming `place` if a particle was not finite or far outside the tank at any time in the
/// run, or if a figure of the report is not finite now.
void check_finite(Simulation& fluid, const std::string& place);

}  // namespace sim
