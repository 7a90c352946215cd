#pragma once
/// Helpers for tests of splitting and merging.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "tests/libsim/fluid_helpers.hpp"

namespace levels_test {

using fluid_test::ParticleState;
using sim::Backend;

inline constexpr double d = 0.15;      // finest spacing
inline constexpr double far_m = 1000;  // radius of a region that contains everything
inline constexpr double gravity = 9.81;

inline sim::TargetRegion everywhere(int level) { return {{0, 0, 0}, far_m, level, level}; }

/// Options for a block of 8 n_* particles of level 0 with targets given by the test.
inline sim::SimulationOptions options_for(Backend backend, std::int64_t n_star, sim::TargetRegion targets) {
  sim::SimulationOptions out;
  out.method = sim::MethodKind::Ours;
  out.backend = backend;
  out.n_star = n_star;
  out.forced_targets = targets;
  return out;
}

inline std::int64_t mass_units(const std::vector<ParticleState>& state) {
  std::int64_t sum = 0;
  for (const auto& p : state) sum += std::int64_t{1} << p.level;
  return sum;
}

/// Total momentum over m_* (the mass of a particle of level 0), m/s.
inline std::array<double, 3> momentum(const std::vector<ParticleState>& state) {
  std::array<double, 3> sum{};
  for (const auto& p : state) {
    const double m = 1 << p.level;
    sum[0] += m * static_cast<double>(p.vx_m_s);
    sum[1] += m * static_cast<double>(p.vy_m_s);
    sum[2] += m * static_cast<double>(p.vz_m_s);
  }
  return sum;
}

inline double share_at(const sim::FrameReport& report, std::size_t level) {
  if (report.particles_by_level.size() <= level) return 0;
  return static_cast<double>(report.particles_by_level[level] << level) /
         static_cast<double>(report.mass_units);
}

/// Expects that splits and merges account for the change of the particle count since `start`, that the mass
/// is `mass`, and that ids are unique.
inline void expect_sound(sim::Simulation& fluid, std::int64_t start, std::int64_t mass) {
  const auto report = fluid.report();
  const auto state = fluid.read_state();
  EXPECT_EQ(report.particles, static_cast<std::int64_t>(state.size()));
  EXPECT_EQ(report.particles, start + static_cast<std::int64_t>(report.levels.born) -
                                  static_cast<std::int64_t>(report.levels.merges));
  EXPECT_EQ(mass_units(state), mass);
  EXPECT_EQ(report.mass_units, mass);
  EXPECT_LE(report.particles, fluid.particle_capacity());
  std::set<int> ids;
  for (const auto& p : state) {
    ids.insert(p.id);
    ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.z_m + p.vx_m_s + p.vy_m_s + p.vz_m_s)) << p.id;
  }
  EXPECT_EQ(ids.size(), state.size());
}

/// Settled water of 12 x 16 x 12 finest spacings in a tank 30 spacings high, and its state.
struct Settled {
  sim::Scene scene = fluid_test::tank({12 * d, 30 * d, 12 * d}, {12 * d, 16 * d, 12 * d}, 60);
  static constexpr std::int64_t n_star = 288;  // 2,304 particles
  std::vector<ParticleState> state;

  explicit Settled(Backend backend) {
    sim::SimulationOptions options;
    options.n_star = n_star;
    options.backend = backend;
    state = sim::make_simulation(scene, options)->read_state();
  }
};

using sim::cases::kinetic_energy;

/// Potential and kinetic energy over m_* (the mass of a particle of level 0), m2/s2.
inline double energy(const std::vector<ParticleState>& state) {
  return gravity * sim::cases::centre_height(state) * static_cast<double>(mass_units(state)) +
         kinetic_energy(state);
}

}  // namespace levels_test
