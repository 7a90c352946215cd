/// Fluid as thick as honey in a tank under full gravity: a slope levels out, and vortices decay, although the
/// particles start on a lattice, which could lock them.

#include "libsim/scene/effects.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

constexpr double d_fine = 0.05;  // spacing of level 0, m

/// Fluid of one level at the start, in a tank with slip walls.
struct Tank {
  int level = 0;                          ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;  ///< must allow particles of this level
  bool mixed = false;                     ///< half of the fluid is at level 0
  Backend backend = Backend::Cpu;

  double spacing() const { return d_fine * std::cbrt(1 << level); }
};

std::unique_ptr<sim::Simulation> fill(const Tank& tank, const Vec3d& size, double nu, State start) {
  auto scene = fluid_test::tank({size[0], 2 * size[1], size[2]}, {});
  scene.viscosity_m2_s = 0;
  scene.effects = {{EffectKind::Viscosity, nu}};
  scene.effects[0].options[static_cast<std::size_t>(sim::EffectOption::ViscosityStick)] = 0;
  sim::SimulationOptions options;
  options.backend = tank.backend;
  options.method = tank.method;
  options.substeps = 2;
  begin_with(std::move(start), tank.level, d_fine, scene, options);
  if (tank.mixed)
    options.forced_targets = sim::TargetRegion{{size[0] / 2, size[1] / 2, size[2]}, size[0] / 2, 0, 3};
  return sim::make_simulation(scene, options);
}

/// The remaining slope, in spacings, after two seconds at level 0: 3 d high over 32 d, in fluid 8 d deep. It
/// swings at first with the rate 3.2 /s; less than 0.01 d should remain.
double slope_left(const Tank& tank) {
  const double d = tank.spacing(), length = 32 * d, depth = 8 * d, height = 3 * d;
  const auto surface = [&](const Vec3d& x) { return depth + height * std::cos(pi * x[0] / length); };
  const auto slope = [&](const State& state) {  // of a cosine, from the centre of mass
    return (length / 2 - mean(state, [](auto& p) { return place(p)[0]; })) * pi * pi * depth /
           (2 * length * d);
  };
  const double larger = d / d_fine;  // the same motion at every size
  const auto fluid =
      fill(tank, {length, 2 * depth, 8 * d}, 0.5 * std::pow(larger, 1.5),
           lattice(
               d, {length, 2 * depth, 8 * d}, [&](const Vec3d& x) { return x[1] < surface(x); },
               [](const Vec3d&) { return Vec3d{}; }));
  const double first = slope(fluid->read_state());
  EXPECT_NEAR(first, 3, 0.2);
  for (int k = 0; k < 120 * std::sqrt(larger); ++k) fluid->step_frame();
  const double left = slope(fluid->read_state());
  std::printf("level %d%s: a slope of %.2f d, %.3f d of it left\n", tank.level, tank.mixed ? ", mixed" : "",
              first, left);
  return left;
}

constexpr double flat = 0.2;  ///< bound of the remaining slope, in spacings

TEST(TruthLevelling, ThickFluidOfOneLevelComesToLevel) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(slope_left({}), 0, flat);
  EXPECT_NEAR(slope_left({.level = 3, .method = MethodKind::LoRes}), 0, flat);
}

TEST(TruthLevellingGpu, ThickFluidComesToLevel) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(slope_left({.backend = Backend::Cuda}), 0, flat);
  EXPECT_NEAR(slope_left({.level = 3, .method = MethodKind::LoRes, .backend = Backend::Cuda}), 0, flat);
}

/// Decay rate of a cell of Taylor-Green vortices over a third of a second, as a ratio to that of its
/// viscosity of 0.1 m2/s.
double cell_back(const Tank& tank, double speed) {
  const double d = d_fine, length = 16 * d, k = pi / length, nu = 0.1;
  const auto flow = [k](const Vec3d& x) {
    return Vec3d{std::sin(k * x[0]) * std::cos(k * x[2]), 0, -std::cos(k * x[0]) * std::sin(k * x[2])};
  };
  const auto still = [](const Vec3d&) { return Vec3d{}; };
  const auto fluid = fill(tank, {length, length, length}, nu,
                          lattice(
                              d, {length, length, length}, [](const Vec3d&) { return true; }, still));
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  fluid->put(moving(fluid->read_state(), [&](const Vec3d& x) {
    Vec3d v = flow(x);
    for (double& one : v) one *= speed;
    return v;
  }));
  std::vector<double> time{0}, logs{std::log(speed)};
  for (int frame = 1; frame <= 20; ++frame) {
    fluid->step_frame();
    double along = 0, norm = 0;
    for (const auto& p : fluid->read_state()) {
      const Vec3d v = velocity(p), e = flow(place(p));
      along += mass(p) * (v[0] * e[0] + v[2] * e[2]);
      norm += mass(p) * (e[0] * e[0] + e[2] * e[2]);
    }
    time.push_back(frame / 60.0);
    logs.push_back(std::log(std::max(along / norm, 1e-9)));
  }
  const double back = -fit(time, logs).slope / (2 * nu * k * k);
  std::printf("vortices at %.1f m/s%s: viscosity %.2f of what was given\n", speed,
              tank.mixed ? ", mixed levels" : "", back);
  return back;
}

/// At level 0 the recovered viscosity is not within 15 % of the given one, so the bound is wide. Without the
/// random shifts by which the effect viscosity loosens the lattice, the ratio is 1.83.
TEST(TruthLevelling, ACreepingVortexUnderGravityDecays) {
  NEEDS_EFFECTS;
  const double back = cell_back({}, 0.3);
  EXPECT_GT(back, 0.85);
  EXPECT_LT(back, 1.7);
}
/// The ratio is 1.30 with mixed levels and 1.5 with one level: the effect acts too strongly in both. The test
/// allows 1.5; the aim is 1.25.
TEST(TruthLevellingSlow, ACreepingVortexOfMixedLevelsDecays) {
  NEEDS_EFFECTS;
  const double back = cell_back({.method = MethodKind::Ours, .mixed = true}, 0.3);
  EXPECT_GT(back, 0.75);
  EXPECT_LT(back, 1.5);
}

}  // namespace
