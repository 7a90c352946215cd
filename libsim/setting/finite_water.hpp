#pragma once
/// Rejects the results of a simulation that became unstable, and prints which guards stepped in.

#include <string>

#include "libsim/simulation.hpp"

namespace sim {

/// Throws base::Error naming `place` if a particle was not finite or far outside the tank at any time in the
/// run, or if a figure of the report is not finite now.
void check_finite(Simulation& fluid, const std::string& place);

/// Field by field.
GuardCounts sum(const GuardCounts& a, const GuardCounts& b);
/// The guards that stepped in, with their counts; empty if none did. Pushes of walls and obstacles, nozzles
/// that waited and lost gazes are normal and left out.
std::string in_words(const GuardCounts& met);
/// Prints both as one line on standard error, after `place`; prints nothing if both are empty.
void print_guards(const std::string& place, const GuardCounts& met, const std::optional<Divergence>& first);
/// The same for a whole run.
void print_guards(const std::string& place, Simulation& fluid);

}  // namespace sim
