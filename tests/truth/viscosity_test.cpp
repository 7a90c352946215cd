/// The effect viscosity recovered from standing shear waves between walls, without gravity.

#include "libsim/scene/effects.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

constexpr double d = 0.05;  // spacing of level 0, m
constexpr int spacings = 12;
constexpr int frames = 12;  // frames, with two substeps each, in which the wave falls to 1 / e

/// An upright column, three widths high, between four walls. Its particles move along y: with slip, v = U
/// cos(pi x / a), which decays at nu (pi / a)^2; without slip, v = U sin(pi x / a) sin(pi z / a), which
/// decays twice as fast.
struct Wave {
  bool sticks = false;
  int level = 0;                               ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;       ///< must allow particles of this level
  std::optional<sim::TargetRegion> targets{};  ///< in widths, relative to the column's middle
  Backend backend = Backend::Cpu;

  double spacing() const { return d * std::cbrt(1 << level); }
  double width() const { return spacings * spacing(); }
  double viscosity() const { return 0.3 * std::sqrt(1 << level); }  // the same motion at every size
  double decay_time() const { return width() * width() / ((sticks ? 2 : 1) * pi * pi * viscosity()); }
  double shape(const Vec3d& x) const {
    const double k = pi / width();
    return sticks ? std::sin(k * x[0]) * std::sin(k * x[2]) : std::cos(k * x[0]);
  }
};

std::unique_ptr<sim::Simulation> column_of(const Wave& wave) {
  const double a = wave.width(), middle = 3 * a;
  auto scene = fluid_test::tank({a, 2 * middle, a}, {});
  scene.gravity_m_s2 = 0;
  scene.viscosity_m2_s = 0;
  scene.frame_dt_s = wave.decay_time() / frames;
  scene.effects = {{EffectKind::Viscosity, wave.viscosity()}};
  scene.effects[0].options[static_cast<std::size_t>(sim::EffectOption::ViscosityStick)] = wave.sticks;
  sim::SimulationOptions options;
  options.backend = wave.backend;
  options.method = wave.method;
  options.substeps = 2;
  State start = lattice(
      wave.spacing(), scene.tank_size_m, [&](const Vec3d& x) { return std::abs(x[1] - middle) < 1.5 * a; },
      [](const Vec3d&) { return Vec3d{}; });
  begin_with(std::move(start), wave.level, d, scene, options);
  if (wave.targets) {
    options.forced_targets = *wave.targets;
    auto& region = *options.forced_targets;
    region.centre_m = {a * (0.5 + region.centre_m[0]), middle + a * region.centre_m[1],
                       a * (0.5 + region.centre_m[2])};
    region.radius_m *= a;
  }
  return sim::make_simulation(scene, options);
}

/// The viscosity that follows from the decay of the wave in the column's middle third, over that of the
/// scene. At the start the fastest particle moves two spacings per decay time.
double viscosity_back(const Wave& wave) {
  const auto fluid = column_of(wave);
  for (int k = 0; k < 10; ++k) fluid->step_frame();  // lets the levels form
  const double speed = 2 * wave.spacing() / wave.decay_time();
  fluid->put(moving(fluid->read_state(), [&](const Vec3d& x) { return Vec3d{0, speed * wave.shape(x), 0}; }));
  std::vector<double> t, logs;
  for (int k = 1; k <= frames; ++k) {
    fluid->step_frame();
    const State state = fluid->read_state();
    const double middle = mean(state, [](const auto& p) { return place(p)[1]; });
    double along = 0, norm = 0;
    for (const auto& p : state) {
      if (std::abs(place(p)[1] - middle) > wave.width() / 2) continue;
      const double shape = wave.shape(place(p));
      along += mass(p) * velocity(p)[1] * shape;
      norm += mass(p) * shape * shape;
    }
    t.push_back(static_cast<double>(k) / frames);
    logs.push_back(std::log(std::max(along / norm, 1e-9)));
  }
  const double back = -fit(t, logs).slope;
  std::string levels;
  for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  std::printf("walls that %s, level %d, by level%s: viscosity %.3f of what was given\n",
              wave.sticks ? "hold" : "let slip", wave.level, levels.c_str(), back);
  return back;
}

constexpr double within = 0.15;
sim::TargetRegion half_fine() { return {{0, 0, 0.5}, 0.5, 0, 3}; }

void waves_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  for (const bool sticks : {false, true}) {
    for (const int level : {0, 3}) {
      const auto method = level == 0 ? MethodKind::HiRes : MethodKind::LoRes;
      EXPECT_NEAR(viscosity_back({.sticks = sticks, .level = level, .method = method, .backend = backend}), 1,
                  within);
    }
  }
}
void waves_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  for (const bool sticks : {false, true}) {
    EXPECT_NEAR(viscosity_back({.sticks = sticks,
                                .level = 3,
                                .method = MethodKind::Ours,
                                .targets = half_fine(),
                                .backend = backend}),
                1, within);
  }
}

TEST(TruthViscosity, WavesOfOneLevelDecay) { waves_of_one_level(Backend::Cpu); }
TEST(TruthViscositySlow, WavesOfMixedLevelsDecay) { waves_of_mixed_levels(Backend::Cpu); }
TEST(TruthViscosityGpu, WavesOfOneLevelDecay) { waves_of_one_level(Backend::Cuda); }
TEST(TruthViscosityGpu, WavesOfMixedLevelsDecay) { waves_of_mixed_levels(Backend::Cuda); }

}  // namespace
