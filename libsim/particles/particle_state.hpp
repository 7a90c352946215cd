#pragma once
/// Particle data for programs, on the host.

#include <cstdint>

namespace sim {

/// A particle for the renderer and the bake.
struct RenderParticle {
  float x_m = 0, y_m = 0, z_m = 0;
  float radius_m = 0;
};

/// The ellipsoid by which the renderer draws a particle: the points x with (x - c)^T S^-1 (x - c) <= 1, with
/// c the RenderParticle's place. S / scale as signed 16-bit fractions, the first in the low half: word 0: xx,
/// yy; 1: zz, xy; 2: xz, yz. Word 3: the scale as a float, m2.
struct RenderShape {
  std::uint32_t word[4];
};

/// A complete particle, for tests, checkpoints and comparisons.
struct ParticleState {
  int id = 0;
  int level = 0;
  float x_m = 0, y_m = 0, z_m = 0;
  float vx_m_s = 0, vy_m_s = 0, vz_m_s = 0;
};

/// Quantity of a particle that pictures show as colours.
enum class ParticleField {
  Speed,         ///< m/s
  DensityError,  ///< rho / rho_0 - 1 in the last projection; rho counts the space behind walls and in
                 ///< obstacles as water
  Active,        ///< 1 = solved in the last frame, 0 = moved by the velocity grid
  Temperature    ///< K above the reference of the effect heat; 0 without the effect
};

}  // namespace sim
