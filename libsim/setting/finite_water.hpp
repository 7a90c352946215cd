#pragma once
/// Rejects the results of a simulation that became unstable, and prints which guards (safety rules of the
/// solver, such as the speed limit) stepped in.

#include <string>

#include "libsim/simulation.hpp"

namespace sim {

/// Throws base::Error naming `place` if a particle was not finite or far outside the tank at any time in the
/// run, or if the density error or the largest speed is not finite now.
void check_finite(Simulation& fluid, const std::string& place);

/// Sum of two counts, field by field.
GuardCounts sum(const GuardCounts& a, const GuardCounts& b);
/// Text with the guards that stepped in and their counts; empty if none did. Pushes of walls and obstacles,
/// waiting nozzles and lost gazes are normal and left out.
std::string in_words(const GuardCounts& met);
/// Prints the guards that stepped in and the first divergence (first sign that the run became unstable) in
/// one line on standard error, after `place`; prints nothing without either.
void print_guards(const std::string& place, const GuardCounts& met, const std::optional<Divergence>& first);
/// Prints the guards and the first divergence of a simulation's whole run.
void print_guards(const std::string& place, Simulation& fluid);

}  // namespace sim
