/// The effect viscosity at obstacles with no slip: the torque on a sphere that turns in the fluid (Lamb,
/// Hydrodynamics, 334), without gravity.

#include "libsim/scene/effects.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/obstacle_scenes.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

constexpr double d = 0.05;  // spacing of level 0, m
constexpr double rho = 1000;
constexpr double nu = 0.3;

/// A sphere in the middle of a cube of fluid whose faces are three radii from the sphere's middle: four walls
/// and a floor without slip, and a free surface. The sphere turns about the vertical.
struct Turning {
  double spacings = 3;                         ///< particles of the start's level per radius of the sphere
  int level = 0;                               ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;       ///< must allow particles of this level
  std::optional<sim::TargetRegion> targets{};  ///< in radii, relative to the sphere's middle
  double stick = 1;
  Backend backend = Backend::Cpu;

  double spacing() const { return d * std::cbrt(1 << level); }
  double radius() const { return spacings * spacing(); }
  double side() const { return 6 * radius(); }
  double viscosity() const { return nu * std::sqrt(1 << level); }  // the same motion at every size
  /// Time in which the slowest mode of the start falls to 1 / e in a ball of three radii.
  double decay_time() const { return 9 * radius() * radius() / (4.49 * 4.49 * viscosity()); }
  /// Slow enough that a particle at the sphere moves one spacing in six decay times.
  double rate() const { return spacing() / radius() / (6 * decay_time()); }
};
constexpr int frames = 12;  // per decay time, with two substeps each

std::unique_ptr<sim::Simulation> start_of(const Turning& it) {
  const double a = it.side(), middle = a / 2;
  auto scene = fluid_test::tank({a, 1.5 * a, a}, {});
  scene.gravity_m_s2 = 0;
  scene.viscosity_m2_s = 0;
  scene.frame_dt_s = it.decay_time() / frames;
  scene.effects = {{EffectKind::Viscosity, it.viscosity()}};
  scene.effects[0].options[static_cast<std::size_t>(sim::EffectOption::ViscosityStick)] = it.stick;
  sim::Obstacle sphere;
  sphere.radius_m = it.radius();
  sphere.start.centre_m = sphere.about_m = {middle, middle, middle};
  sphere.motion = sim::ObstacleMotion::Turns;
  sphere.rate_rad_s = it.rate();
  scene.obstacles = {sphere};
  sim::SimulationOptions options;
  options.backend = it.backend;
  options.method = it.method;
  options.substeps = 2;
  options.wall_impulse = true;
  State start = lattice(
      it.spacing(), scene.tank_size_m,
      [&](const Vec3d& x) { return x[1] < a && sim::signed_distance(sphere, sphere.start, x) > 0; },
      [](const Vec3d&) { return Vec3d{}; });
  begin_with(std::move(start), it.level, d, scene, options);
  if (it.targets) {
    options.forced_targets = *it.targets;
    for (double& at : options.forced_targets->centre_m) at = middle + at * it.radius();
    options.forced_targets->radius_m *= it.radius();
  }
  return sim::make_simulation(scene, options);
}

/// Torque of the fluid on the sphere against its rotation, mean over the fourth decay time, over that in
/// unbounded fluid, 8 pi rho nu R^3 Omega.
double torque_of(const Turning& it) {
  const auto fluid = start_of(it);
  double sum = 0;
  for (int k = 0; k < 4 * frames; ++k) {
    fluid->step_frame();
    if (k >= 3 * frames) sum += fluid->momentum().obstacles.at(0).moment[1];
  }
  const double endless = 8 * pi * rho * it.viscosity() * std::pow(it.radius(), 3) * it.rate();
  const double out = sum / it.decay_time() / endless;
  std::string levels;
  for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  std::printf("sphere that turns, level %d, by level%s: torque %.3f of that without walls\n", it.level,
              levels.c_str(), out);
  return out;
}

constexpr double within = 0.15;
/// Inside a no-slip ball of three radii the torque is 1 / (1 - 1 / 27) times that without walls, and inside
/// one through the cube's corners 1 / (1 - 1 / 140); the cube is between the two.
constexpr double torque = 1.02;

void spheres_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(torque_of({.backend = backend}), torque, within);
  EXPECT_NEAR(torque_of({.level = 3, .method = MethodKind::LoRes, .backend = backend}), torque, within);
}
void a_sphere_among_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(torque_of({.level = 3,
                         .method = MethodKind::Ours,
                         .targets = sim::TargetRegion{{0, 0, 2}, 2, 0, 3},
                         .backend = backend}),
              torque, within);
}

/// A free ball of 300 kg/m3 and 0.18 m in fluid of 1 m2/s. Stokes' law lets it rise at 0.049 m/s, and walls
/// at 2.5 radii by about half of that. Where the fluid has its gravity before its pressure and the ball both,
/// the fluid drags it down instead.
void light_ball_rises(Backend backend) {
  NEEDS_EFFECTS;
  auto scene = fluid_test::tank({0.9, 1.2, 0.9}, {0.9, 0.8, 0.9}, 18);
  scene.gate = false;
  scene.viscosity_m2_s = 0;
  scene.min_substeps = 2;
  scene.effects = {{EffectKind::Viscosity, 1}};
  scene.obstacles = {obstacle_test::free_one(obstacle_test::sphere({0.45, 0.4, 0.45}, 0.18), 300)};
  sim::SimulationOptions options;
  options.n_star = 120;
  options.backend = backend;
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 48; ++frame) fluid->step_frame();
  const double rise = fluid->read_obstacles()[0].pose.centre_m[1] - 0.4;
  std::printf("a light ball rises by %.4f m in 0.8 s\n", rise);
  EXPECT_GT(rise, 0.005);
  EXPECT_LT(rise, 0.06);
}

TEST(TruthViscosityAtObstacles, ALightBallRises) { light_ball_rises(Backend::Cpu); }
TEST(TruthViscosityAtObstaclesGpu, ALightBallRises) { light_ball_rises(Backend::Cuda); }
TEST(TruthViscosityAtObstacles, SpheresThatTurnNeedTheirTorque) { spheres_of_one_level(Backend::Cpu); }
TEST(TruthViscosityAtObstaclesSlow, ASphereThatTurnsAmongMixedLevelsNeedsItsTorque) {
  a_sphere_among_mixed_levels(Backend::Cpu);
}
TEST(TruthViscosityAtObstaclesGpu, SpheresThatTurnNeedTheirTorque) { spheres_of_one_level(Backend::Cuda); }
TEST(TruthViscosityAtObstaclesGpu, ASphereThatTurnsAmongMixedLevelsNeedsItsTorque) {
  a_sphere_among_mixed_levels(Backend::Cuda);
}

}  // namespace
