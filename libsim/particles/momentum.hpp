#pragma once
/// Sums of mass times a vector in fixed point, so that they do not depend on the order of addition.

#include <cstdint>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Sum of mass times a vector, in units of 2^-Bits. m_* is the mass of a particle of level 0.
template <int Bits>
struct MassSum {
  std::uint64_t x, y, z;

  static constexpr float unit = 1.0f / static_cast<float>(1ull << Bits);

  /// Adds `mass` in m_* times v, each component limited to +-2^(56 - Bits); a vector that is not finite
  /// counts as zero.
  SIM_FN void add(float mass, Vec3 v) {
    if (!all_finite(v)) return;
    x += fixed(mass * v.x);
    y += fixed(mass * v.y);
    z += fixed(mass * v.z);
  }
  /// Adds a sum atomically.
  SIM_FN void add_at_once(const MassSum& other) {
    atomic_add(&x, other.x);
    atomic_add(&y, other.y);
    atomic_add(&z, other.z);
  }
  friend SIM_FN MassSum operator+(const MassSum& a, const MassSum& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend SIM_FN MassSum operator-(const MassSum& a, const MassSum& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  /// Converts from fixed point.
  SIM_FN Vec3 value() const { return {in_units(x), in_units(y), in_units(z)}; }

 private:
  SIM_FN static float in_units(std::uint64_t sum) {
    return unit * static_cast<float>(static_cast<std::int64_t>(sum));
  }
  SIM_FN static std::uint64_t fixed(float value) {
    // Limit of one term, so that a sum of 100 terms at this limit does not overflow.
    constexpr auto most = static_cast<float>(1ull << (56 - Bits));
    return static_cast<std::uint64_t>(
        static_cast<std::int64_t>(rintf(at_most(at_least(value, -most), most) / unit)));
  }
};

/// Sum of mass times velocity, in m_* m/s.
using Momentum = MassSum<24>;
/// Sum of mass times displacement within a substep, in m_* m.
using MassWay = MassSum<36>;

/// Mass of a particle of support h in m_*, the mass of a particle of level 0.
SIM_FN float mass_units_of(float h, float finest_support) {
  const float ratio = h / finest_support;
  return ratio * ratio * ratio;
}

}  // namespace sim::SIM_BACKEND
