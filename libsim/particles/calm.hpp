#pragma once
/// Gravity, and the criterion for water at rest.

#include <cmath>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Gravity: the acceleration of all water and free bodies.
struct Fall {
  float strength = 9.81f;  ///< m/s2; 0 without gravity
  Vec3 up{0, 1, 0};        ///< unit vector against gravity; its zeros are +0, never -0; +y without gravity

  Fall() = default;
  /// Gravity of `down` m/s2 along -y.
  Fall(float down) : strength(down) {}
  Fall(float size, Vec3 against) : strength(size), up(against) {}
  /// Minus the acceleration of gravity, m/s2.
  SIM_FN Vec3 lift() const { return strength * up; }
  /// Unit vector along the coordinate axis nearest to `up`, with its sign.
  Vec3 axis() const {
    const Vec3 size{std::abs(up.x), std::abs(up.y), std::abs(up.z)};
    if (size.y >= size.x && size.y >= size.z) return {0, std::copysign(1.0f, up.y), 0};
    if (size.x >= size.z) return {std::copysign(1.0f, up.x), 0, 0};
    return {0, 0, std::copysign(1.0f, up.z)};
  }
};

/// Degree to which a particle is at rest: 1 - (speed / limit speed)^2, or 0 from the limit speed on.
struct Calm {
  float inverse_square = 0;  ///< 1 / limit speed^2, s2/m2; 0 = no particle is at rest
  float most = 0;            ///< value at speed 0: 1, or 0 if no particle is at rest

  // Contains no branch, so that loops that call this operator vectorise.
  SIM_FN float operator()(float vx, float vy, float vz) const {
    return of_square(vx * vx + vy * vy + vz * vz);
  }
  /// The degree at a speed with this square, m2/s2.
  SIM_FN float of_square(float square) const { return at_least(most - inverse_square * square, 0.0f); }
};

/// Calm with the limit speed share x sqrt(g d_*): g in m/s2, finest spacing d_* in m. Without gravity no
/// particle is at rest.
inline Calm calm_below(double share, double gravity, double finest_spacing) {
  const double square = share * share * gravity * finest_spacing;
  if (!(square > 0)) return {};
  return {static_cast<float>(1 / square), 1};
}

/// Degree to which a particle is at rest for the rules of levels: 1 up to 1.06 times the limit speed
/// Readings::calm_speed x sqrt(g d_*), falling to 0 at 1.5 times it.
struct LevelRest {
  static constexpr double fades_at = 1.5;  ///< speed from which the degree is 0, in limit speeds
  Calm calm;                               ///< with fades_at times the limit speed
  SIM_FN float operator()(Vec4 v) const { return at_most(2 * calm(v.x, v.y, v.z), 1.0f); }
};

}  // namespace sim::SIM_BACKEND
