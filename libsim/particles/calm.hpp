#pragma once
/// What counts as water at rest.

#include <cmath>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// How much a particle belongs to water at rest, by its speed: 1 without motion, 0 from `speed` on.
struct Calm {
  float inverse_square = 0;  ///< 1 / speed^2, s2/m2; 0 = nothing rests

  SIM_FN float operator()(float vx, float vy, float vz) const {
    if (inverse_square == 0) return 0;
    return at_least(1 - inverse_square * (vx * vx + vy * vy + vz * vz), 0.0f);
  }
};

/// `share` of sqrt(g d_*), with g in m/s2 and the finest spacing d_* in m. Without gravity nothing rests.
inline Calm calm_below(double share, double gravity, double finest_spacing) {
  const double square = share * share * gravity * finest_spacing;
  return {square > 0 ? static_cast<float>(1 / square) : 0};
}

}  // namespace sim::SIM_BACKEND
