#pragma once
/// Weakens the density constraint near particles that just split or merged; after Orthmann and Kolb 2012.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Compression is rho / rho_0 - 1. Up to `overlap`, the compression that splits and merges cause, the
/// constraint is weakened most. Higher compression means an impact on a wall or on other water. From `impact`
/// on the whole constraint applies.
struct Easing {
  static constexpr float overlap = 0.02f;
  static constexpr float impact = 0.1f;

  /// Returns the share of the density constraint that a particle enforces, (0, 1]. `ease`: the smallest
  /// share, by the age of the youngest particle nearby (LevelRules::ease). `density`: rho / rho_0.
  SIM_FN static float share(float ease, float density) {
    return at_least(ease, at_most((density - 1 - overlap) / (impact - overlap), 1.0f));
  }
};

}  // namespace sim::SIM_BACKEND
