#pragma once
/// Positions of the children of a split (Algorithm 1): on 2^(k-1) diagonals of a randomly rotated cube.

#include "libsim/levels/level_state.hpp"
#include "libsim/particles/kernels.hpp"
#include "libsim/particles/random.hpp"

namespace sim::SIM_BACKEND {

/// Describes a split: into 2^k children, rotated by the `attempt`-th random rotation.
struct SplitCode {
  int k, attempt;
  static constexpr int attempts = 4;

  SIM_FN std::uint8_t packed() const { return static_cast<std::uint8_t>(k | attempt << 2); }
  SIM_FN static SplitCode unpacked(std::uint8_t code) { return {code & 3, code >> 2}; }
};

/// A rotation, as three rows.
struct Turn {
  Vec3 x, y, z;
  SIM_FN Vec3 operator()(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

/// Uniform over all rotations (K. Shoemake 1992), from (id, frame, attempt).
SIM_FN Turn random_turn(int id, std::uint32_t frame, int attempt) {
  const auto uniform = [&](std::uint32_t which) {
    const std::uint32_t salt = 3 * static_cast<std::uint32_t>(attempt) + which;
    return uniform_of(random_bits(static_cast<std::uint32_t>(id), frame, salt));
  };
  const float u = uniform(0);
  const float a = 2 * pi * uniform(1);
  const float b = 2 * pi * uniform(2);
  const float qx = sqrtf(1 - u) * sinf(a);
  const float qy = sqrtf(1 - u) * cosf(a);
  const float qz = sqrtf(u) * sinf(b);
  const float qw = sqrtf(u) * cosf(b);
  return {{1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)},
          {2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)},
          {2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)}};
}

/// Offset of child c, 0 <= c < 2^k, from a parent of radius r. Children 2 n and 2 n + 1 are opposite each
/// other, so that the centre of mass and, with equal velocities, the angular momentum are conserved.
SIM_FN Vec3 child_offset(const Turn& turn, const LevelRules& rules, SplitCode code, float radius, int c) {
  const int diagonal = c / 2;
  const float sign = c % 2 ? -1.0f : 1.0f;
  const Vec3 corner{diagonal == 3 ? -1.0f : 1.0f, diagonal == 2 ? -1.0f : 1.0f, diagonal == 1 ? -1.0f : 1.0f};
  const float length = rules.split_offset[code.k - 1] * radius * 0.577350269f;
  return (sign * length) * turn(corner);
}

}  // namespace sim::SIM_BACKEND
