#pragma once
/// Balances of a run: mass, particles, momentum and energy, for a test of any scene. Set
/// SimulationOptions::wall_impulse, make a Ledger of the run, then call frame() after each step_frame.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"

namespace ledger_test {

using sim::ParticleState;
using sim::Vec3d;

/// Largest of three magnitudes.
inline double size_of(const Vec3d& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

class Ledger {
 public:
  /// `fluid` must outlive this. Potential energy counts from the floor and ignores a central force.
  Ledger(sim::Simulation& fluid, const sim::Scene& scene, std::int64_t n_star)
      : fluid_(fluid), scene_(scene) {
    const double edge = sim::resolution_of(scene, sim::MethodKind::HiRes, n_star).finest_spacing_m;
    unit_mass_ = 1000 * edge * edge * edge;
    const auto report = fluid.report();
    particles_ = report.particles;
    mass_ = report.mass_units + report.reservoir;
    energy_ = energy_of(fluid.read_state());
    for (const auto& nozzle : scene.nozzles) {
      const double u = nozzle.speed_m_s;
      poured_energy_ = std::max(poured_energy_, u * u / 2 + scene.gravity_m_s2.size() * nozzle.position_m[1]);
    }
  }

  /// Checks the balances of particles and mass of the last frame, and takes momentum and energy into
  /// balance().
  void frame() {
    const auto report = fluid_.report();
    const auto state = fluid_.read_state();
    const auto signed_of = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
    EXPECT_EQ(report.particles, static_cast<std::int64_t>(state.size()));
    EXPECT_EQ(report.particles, particles_ + report.particles_in - report.particles_out +
                                    signed_of(report.levels.born) - signed_of(report.levels.merges))
        << "frame " << report.frame;
    EXPECT_EQ(report.mass_units + report.reservoir + report.drained, mass_) << "frame " << report.frame;
    energy(report, state);
    momentum(state);
  }

  /// Balance of the whole run; each value is a share of `gross` unless its comment says otherwise.
  struct Balance {
    double gross = 0;         ///< kg m/s: sum over frames of the forces' or the walls' impulse, the larger
    double open = 0;          ///< change of momentum that no entry of the run's account explains
    double unattributed = 0;  ///< part of the constraint's impulse that no wall gave
    double rests = 0;         ///< `unattributed`, plus what unsolved particles took from the velocity grid
    double forces = 0;        ///< impulse of the forces less g M dt
    double event = 0;   ///< largest momentum of a frame's splits and merges, as a share of the sum of m |v|
    double energy = 0;  ///< largest energy, as a share of the energy of the start and of poured water
  };
  Balance balance() const {
    Balance out = most_;
    out.gross = std::max(given_by_forces_, given_by_walls_);
    out.open = size_of(open_) / out.gross;
    out.unattributed = size_of(unattributed_) / out.gross;
    out.rests = size_of(rests_) / out.gross;
    out.forces = size_of(forces_) / out.gross;
    return out;
  }

 private:
  double energy_of(const std::vector<ParticleState>& state) const {
    double sum = 0;
    for (const auto& p : state) {
      const double v = std::hypot(static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                                  static_cast<double>(p.vz_m_s));
      sum += (1 << p.level) * (v * v / 2 + scene_.gravity_m_s2.size() * static_cast<double>(p.y_m));
    }
    return sum;
  }

  void energy(const sim::FrameReport& report, const std::vector<ParticleState>& state) {
    const double brought = energy_ + poured_energy_ * static_cast<double>(report.poured);
    most_.energy = std::max(most_.energy, energy_of(state) / brought);
  }

  void momentum(const std::vector<ParticleState>& state) {
    const auto account = fluid_.momentum();
    Vec3d now{};
    double mass = 0, moving = 0;
    for (const auto& p : state) {
      const double m = unit_mass_ * (1 << p.level);
      const Vec3d v{static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                    static_cast<double>(p.vz_m_s)};
      for (std::size_t k = 0; k < 3; ++k) now[k] += m * v[k];
      mass += m;
      moving += m * std::hypot(v[0], v[1], v[2]);
    }
    const double weight = mass * scene_.gravity_m_s2.size() * scene_.frame_dt_s;
    const Vec3d walls = account.walls_sum();
    // The account's own sums must match the particles': rounding is 2^-24 m/s a particle.
    EXPECT_LT(size_of({now[0] - account.after[0], now[1] - account.after[1], now[2] - account.after[2]}),
              1e-6 * (moving + weight));
    for (std::size_t k = 0; k < 3; ++k) {
      open_[k] += account.after[k] - account.before[k] - account.forces[k] - walls[k] - account.flow[k] -
                  account.levels[k] - account.braked[k] - account.viscosity[k] - account.inherited[k] -
                  account.effects[k] - account.unattributed[k];
      unattributed_[k] += account.unattributed[k];
      rests_[k] += account.unattributed[k] + account.inherited[k];
      forces_[k] += account.forces[k] + (k == 1 ? weight : 0);
    }
    given_by_forces_ += size_of(account.forces);
    given_by_walls_ += size_of(walls);
    if (moving > 0) most_.event = std::max(most_.event, size_of(account.levels) / moving);
  }

  sim::Simulation& fluid_;
  const sim::Scene& scene_;
  double unit_mass_ = 0;  ///< mass of a particle of level 0, m_*, kg
  std::int64_t particles_ = 0;
  std::int64_t mass_ = 0;     ///< in m_*
  double energy_ = 0;         ///< at the start, over m_*, m2/s2
  double poured_energy_ = 0;  ///< upper bound per poured m_*, over m_*, m2/s2
  double given_by_forces_ = 0, given_by_walls_ = 0;
  Vec3d open_{}, unattributed_{}, rests_{}, forces_{};
  Balance most_;
};

}  // namespace ledger_test
