#pragma once
/// Surface energies from which the tension forces follow, for pairs and for walls.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Strengths of the two tension terms, attraction (pull) and smoothing, in units of the tension sigma. They
/// were calibrated together with the oscillation period of one drop of level 0 (docs/decisions.md). Tests
/// measure sigma from other cases.
inline constexpr float pull_strength = 12;
inline constexpr float smoothing_strength = 2.6f;
/// Width of a density range, in units of rho_0: the attraction is full up to a density of 1 - skin_depth, and
/// decreases to 0 at 1.
inline constexpr float skin_depth = 0.2f;

/// Degree to which a particle of this rho / rho_0 belongs to the surface, 0 .. 1.
SIM_FN float skin(float density) { return at_most(at_least((1 - density) / skin_depth, 0.0f), 1.0f); }

}  // namespace sim::SIM_BACKEND
