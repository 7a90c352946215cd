#pragma once
/// Momentum in fixed point, so that a sum does not depend on the order of adding.

#include <cstdint>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Over m_*, m/s.
struct Momentum {
  std::uint64_t x, y, z;

  static constexpr float unit = 1.0f / (1 << 24);

  /// Adds `mass` in m_* at this velocity; one that is not finite counts as rest.
  SIM_FN void add(float mass, Vec3 v) {
    if (!all_finite(v)) return;
    x += fixed(mass * v.x);
    y += fixed(mass * v.y);
    z += fixed(mass * v.z);
  }
  /// Adds a sum while others do.
  SIM_FN void add_at_once(const Momentum& other) {
    atomic_add(&x, other.x);
    atomic_add(&y, other.y);
    atomic_add(&z, other.z);
  }
  friend SIM_FN Momentum operator+(const Momentum& a, const Momentum& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend SIM_FN Momentum operator-(const Momentum& a, const Momentum& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }

 private:
  SIM_FN static std::uint64_t fixed(float value) {
    constexpr float most = 1e10f;  // of one particle; a sum of many has room
    return static_cast<std::uint64_t>(
        static_cast<std::int64_t>(rintf(fminf(fmaxf(value, -most), most) / unit)));
  }
};

/// Mass of a particle of support h in m_*.
SIM_FN float mass_units_of(float h, float finest_support) {
  const float ratio = h / finest_support;
  return ratio * ratio * ratio;
}

}  // namespace sim::SIM_BACKEND
