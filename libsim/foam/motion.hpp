#pragma once
/// Motion of spray, foam and bubbles (Ihmsen et al. 2012, section 4).

#include "libsim/foam/emission.hpp"

namespace sim::SIM_BACKEND {

using FoamWaterView = Reads<Column::Position, Column::Velocity>;

/// Moves the diffuse particles over a frame with the surrounding water, ages foam, and records in the ledger
/// which dissolved or left. Particles beyond the walls' openings have left. Walls and obstacles stop
/// particles; a moving obstacle carries them along.
template <class Bounds>
void move_foam(FoamPool& pool, FoamWaterView water, const Grid& grid, const Bounds& bounds,
               const FoamRules& rules);

}  // namespace sim::SIM_BACKEND
