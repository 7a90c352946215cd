#pragma once
/// Physical importance F_pim of particles (ViP-Fluid Eq. 12-14).

#include "libsim/activation/activation.hpp"

namespace sim::SIM_BACKEND {

using ImportanceView = Reads<Column::Position, Column::Level>;

/// Computes activation.importance from the mean velocities V^n and kinetic energies E^n of activation.grid,
/// and updates activation.range. saliency: s in [0, 1] per particle; nullptr counts as 0. speed_floor:
/// epsilon_v, m/s, which limits the divisors from below.
void measure_importance(Activation& activation, ImportanceView particles, const float* saliency,
                        float speed_floor);

}  // namespace sim::SIM_BACKEND
