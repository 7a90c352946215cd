#pragma once
/// Share of its constraint that a particle near a fresh one enforces; after Orthmann and Kolb 2012.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// `overlap`: rho / rho_0 - 1 up to which the constraint is weakened, as much as splits and merges cause.
/// Higher compression means an impact on a wall or other water; from `impact` on the whole constraint
/// applies.
struct Easing {
  static constexpr float overlap = 0.02f;
  static constexpr float impact = 0.1f;

  /// Share of the constraint, (0, 1]. `ease`: the share for the youngest particle nearby. `density`: rho /
  /// rho_0.
  SIM_FN static float share(float ease, float density) {
    return at_least(ease, at_most((density - 1 - overlap) / (impact - overlap), 1.0f));
  }
};

}  // namespace sim::SIM_BACKEND
