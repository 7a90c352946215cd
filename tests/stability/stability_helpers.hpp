#pragma once
/// Shared by the tests of hard cases. docs/results.md lists cases S1 to S24.

#include <gtest/gtest.h>

#include "tests/libsim/fluid_helpers.hpp"

namespace stability_test {

using fluid_test::ParticleState;
using sim::Backend;

inline constexpr double d = 0.15;  ///< finest spacing, m
inline constexpr double gravity = 9.81;

/// nx x ny x nz particles of level 0 on the lattice from `low`, moving at `speed` along x.
inline std::vector<ParticleState> block(int nx, int ny, int nz, const sim::Vec3d& low, double speed = 0) {
  std::vector<ParticleState> out;
  const auto at = [&](std::size_t axis, int k) { return static_cast<float>(low[axis] + d * (k + 0.5)); };
  for (int i = 0; i < nx * ny * nz; ++i) {
    out.push_back(
        {i, 0, at(0, i % nx), at(1, i / nx / nz), at(2, i / nx % nz), static_cast<float>(speed), 0, 0});
  }
  return out;
}

/// A run of HiRes from these particles at spacing d in an open tank.
inline std::unique_ptr<sim::Simulation> start_from(Backend backend, sim::Scene scene,
                                                   const std::vector<ParticleState>& start,
                                                   sim::SimulationOptions options = {}) {
  scene.water.front().max_m = {8 * d, 8 * d, 8 * d};
  options.n_star = 64;  // 512 particles in the block: spacing d
  options.backend = backend;
  options.start = start;
  return sim::make_simulation(scene, options);
}

/// start_from() in a cube of 2 m, with three substeps a frame.
inline std::unique_ptr<sim::Simulation> start_in_a_cube(Backend backend,
                                                        const std::vector<ParticleState>& start) {
  sim::SimulationOptions options;
  options.substeps = 3;
  return start_from(backend, fluid_test::tank({2, 2, 2}, {2, 2, 2}), start, options);
}

/// True if both states are equal bit for bit.
inline bool same(const std::vector<ParticleState>& a, const std::vector<ParticleState>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
           return p.id == q.id && p.level == q.level && p.x_m == q.x_m && p.y_m == q.y_m && p.z_m == q.z_m &&
                  p.vx_m_s == q.vx_m_s && p.vy_m_s == q.vy_m_s && p.vz_m_s == q.vz_m_s;
         });
}

}  // namespace stability_test
