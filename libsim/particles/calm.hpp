#pragma once
/// The criterion for water at rest.

#include <cmath>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Degree to which a particle is at rest, by its speed: 1 without motion, 0 from `speed` on.
struct Calm {
  float inverse_square = 0;  ///< 1 / speed^2, s2/m2; 0 = nothing rests
  float most = 0;            ///< value without motion: 1, or 0 if nothing rests

  // Branch-free for vectorised loops.
  SIM_FN float operator()(float vx, float vy, float vz) const {
    return at_least(most - inverse_square * (vx * vx + vy * vy + vz * vz), 0.0f);
  }
};

/// Rest below `share` of sqrt(g d_*), with g in m/s2 and the finest spacing d_* in m. Without gravity nothing
/// rests.
inline Calm calm_below(double share, double gravity, double finest_spacing) {
  const double square = share * share * gravity * finest_spacing;
  if (!(square > 0)) return {};
  return {static_cast<float>(1 / square), 1};
}

}  // namespace sim::SIM_BACKEND
