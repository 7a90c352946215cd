#pragma once
/// Drops without gravity, for the tests of surface tension and adhesion.

#include "libsim/scene/effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace truth_test {

/// A ball or a part of a ball, in a cubic tank without a lid.
struct Drop {
  double spacings = 8;                         ///< particles of the start's level per radius
  int level = 0;                               ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;       ///< must allow particles of this level
  std::optional<sim::TargetRegion> targets{};  ///< in radii, relative to the drop's middle
  double tension = 10;
  double work = 0;        ///< work of adhesion over the tension; 0: none
  double width = 4;       ///< width of the tank, in radii
  double damping = 2e-3;  ///< viscosity, in units of R^2 omega
  /// Height of the drop's middle; nullopt: the middle of the tank.
  std::optional<double> height{};
  std::vector<sim::Obstacle> obstacles{};
  Backend backend = Backend::Cpu;

  static constexpr double finest = 0.05;  ///< spacing of level 0, m
  static constexpr double rho = 1000;
  double spacing() const { return finest * std::cbrt(1 << level); }
  double radius() const { return spacings * spacing(); }
  double tank() const { return width * radius(); }
  Vec3d middle() const { return {tank() / 2, height.value_or(tank() / 2), tank() / 2}; }
  /// Period of the mode l = 2: omega^2 = 8 sigma / (rho R^3).
  double period() const { return 2 * pi / std::sqrt(8 * tension / (rho * std::pow(radius(), 3))); }
  /// Frames in one period: substeps of at most an eighth of sqrt(rho d^3 / sigma).
  int frames() const { return static_cast<int>(std::ceil(2.22 * std::pow(spacings, 1.5) * 8)); }
};

/// A run that starts from the particles that are `inside`, a test of the position in metres from the drop's
/// middle.
inline std::unique_ptr<sim::Simulation> start_of(const Drop& drop,
                                                 const std::function<bool(const Vec3d&)>& inside) {
  const double width = drop.tank();
  const Vec3d middle = drop.middle();
  auto scene = fluid_test::tank({width, width, width}, {width, width, width});
  scene.gravity_m_s2 = 0;
  scene.min_substeps = 1;
  scene.viscosity_m2_s = drop.damping * drop.radius() * drop.radius() * 2 * pi / drop.period();
  scene.frame_dt_s = drop.period() / drop.frames();
  scene.effects = {{sim::EffectKind::Cohesion, drop.tension}};
  if (drop.work > 0) scene.effects.push_back({sim::EffectKind::Adhesion, drop.work * drop.tension});
  scene.obstacles = drop.obstacles;
  const auto from_middle = [&](const Vec3d& x) {
    return Vec3d{x[0] - middle[0], x[1] - middle[1], x[2] - middle[2]};
  };
  State start = lattice(
      drop.spacing(), scene.tank_size_m, [&](const Vec3d& x) { return inside(from_middle(x)); },
      [](const Vec3d&) { return Vec3d{}; });
  sim::SimulationOptions options;
  options.backend = drop.backend;
  options.method = drop.method;
  begin_with(std::move(start), drop.level, Drop::finest, scene, options);
  if (drop.targets) {
    options.forced_targets = *drop.targets;
    for (std::size_t k = 0; k < 3; ++k) {
      double& at = options.forced_targets->centre_m[k];
      at = middle[k] + at * drop.radius();
    }
    options.forced_targets->radius_m *= drop.radius();
  }
  return sim::make_simulation(scene, options);
}
/// True for positions in a ball of the drop's radius.
inline std::function<bool(const Vec3d&)> in_ball(const Drop& drop) {
  return [radius = drop.radius()](const Vec3d& x) { return std::hypot(x[0], x[1], x[2]) <= radius; };
}

}  // namespace truth_test
