#pragma once
/// How spray, foam and bubbles move (Ihmsen et al. 2012, section 4).

#include "libsim/foam/emission.hpp"

namespace sim::SIM_BACKEND {

using FoamWaterView = Reads<Column::Position, Column::Velocity>;

/// Moves the diffuse particles over a frame by the water round them, lets foam age, and enters in the ledger
/// who dissolved or left. What lies behind the walls' openings has left. Walls and obstacles hold back what
/// comes to them; a moving one takes it along.
template <class Bounds>
void move_foam(FoamPool& pool, FoamWaterView water, const Grid& grid, const Bounds& bounds,
               const FoamRules& rules);

}  // namespace sim::SIM_BACKEND
