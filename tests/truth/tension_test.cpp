/// Effects measured back from the motion: tension by the period of drops without gravity (Rayleigh 1879), air
/// drag by the speed at which drops fall at last.

#include "libsim/scene/effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

#define NEEDS_EFFECTS \
  if (!sim::has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=OFF"

constexpr double d = 0.05;  // of level 0
constexpr double rho = 1000;

/// A drop of `spacings` times the spacing of its start's level, in a tank four radii wide.
struct Drop {
  double spacings = 8;
  int level = 0;                               ///< of the start
  MethodKind method = MethodKind::HiRes;       ///< that holds this level
  std::optional<sim::TargetRegion> targets{};  ///< in radii, from the drop's middle
  double beta = 1;
  double tension = 10;
  Backend backend = Backend::Cpu;

  double radius() const { return spacings * d * std::cbrt(1 << level); }
  /// Of l = 2: omega^2 = 8 sigma / (rho R^3).
  double period() const { return 2 * pi / std::sqrt(8 * tension / (rho * std::pow(radius(), 3))); }
};

std::array<double, 3> half_axes(const State& state) {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double middle = mean(state, [&](const auto& p) { return place(p)[k]; });
    out[k] = std::sqrt(5 * mean(state, [&](const auto& p) { return std::pow(place(p)[k] - middle, 2); }));
  }
  return out;
}
/// Logarithm of how much longer the drop is along y than in the mean.
double stretch(const State& state) {
  const auto a = half_axes(state);
  return std::log(a[1] / std::sqrt(a[0] * a[2])) * 2 / 3;
}

/// Frames a period: substeps of at most an eighth of sqrt(rho d^3 / sigma).
int frames_of(const Drop& drop) {
  return static_cast<int>(
      std::ceil(2.22 * std::pow(drop.radius() / (d * std::cbrt(1 << drop.level)), 1.5) * 8));
}

std::unique_ptr<sim::Simulation> start_of(const Drop& drop, const std::function<bool(const Vec3d&)>& inside) {
  const double width = 4 * drop.radius(), middle = width / 2;
  const double spacing = d * std::cbrt(1 << drop.level);
  auto scene = fluid_test::tank({width, width, width}, {width, width, width});
  scene.gravity_m_s2 = 0;
  scene.min_substeps = 1;
  scene.viscosity_m2_s = 0.002 * drop.radius() * drop.radius() * 2 * pi / drop.period();
  scene.frame_dt_s = drop.period() / frames_of(drop);
  scene.effects = {{EffectKind::Cohesion, drop.tension}};
  State start = lattice(
      spacing, scene.tank_size_m,
      [&](const Vec3d& x) {
        return inside({x[0] - middle, x[1] - middle, x[2] - middle});
      },
      [](const Vec3d&) { return Vec3d{}; });
  for (auto& p : start) p.level = drop.level;
  sim::SimulationOptions options;
  options.backend = drop.backend;
  options.method = drop.method;
  options.n_star = static_cast<std::int64_t>(start.size() << drop.level) / 8 + 1;
  scene.fill_max_m = {2 * d * static_cast<double>(options.n_star), 2 * d, 2 * d};
  if (drop.targets) {
    options.forced_targets = *drop.targets;
    for (double& at : options.forced_targets->centre_m) at = middle + at * drop.radius();
    options.forced_targets->radius_m *= drop.radius();
  }
  if (drop.beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(drop.beta) / (2 * 0.02);  // beta = exp(2 b tau)
  }
  options.start = start;
  return sim::make_simulation(scene, options);
}

/// sigma from the frequency and the decay of the damped swing that fits best, over what the scene lists: a
/// drop swings at sqrt(omega_0^2 - gamma^2).
double tension_back(const Drop& drop) {
  const auto fluid =
      start_of(drop, [&](const Vec3d& x) { return std::hypot(x[0], x[1], x[2]) <= drop.radius(); });
  const int frames = frames_of(drop);
  for (int k = 0; k < frames / 5; ++k) fluid->step_frame();
  const double omega = 2 * pi / drop.period();
  State state = fluid->read_state();
  const double middle = 2 * drop.radius();
  state = moving(state, [&](const Vec3d& x) {
    const double strain = 0.3 * omega;
    return Vec3d{-strain / 2 * (x[0] - middle), strain * (x[1] - middle), -strain / 2 * (x[2] - middle)};
  });
  fluid->put(state);
  std::vector<double> t, y;
  while (t.size() < static_cast<std::size_t>(frames) * 6 / 5) {
    fluid->step_frame();
    t.push_back(static_cast<double>(t.size() + 1) / frames);
    y.push_back(stretch(fluid->read_state()));
  }
  double least = 1e9, found = 0;
  for (double f = 0.4; f < 2; f += 0.01) {
    for (double decay = 0; decay < 4; decay += 0.1) {
      double cross = 0, square = 0, all = 0;
      for (std::size_t i = 0; i < t.size(); ++i) {
        const double swing = std::exp(-decay * t[i]) * std::sin(2 * pi * f * t[i]);
        cross += swing * y[i];
        square += swing * swing;
        all += y[i] * y[i];
      }
      const double left = all - cross * cross / square;
      if (left >= least) continue;
      least = left;
      found = f * f + std::pow(decay / (2 * pi), 2);
    }
  }
  const auto report = fluid->report();
  std::string levels;
  for (const auto n : report.particles_by_level) levels += " " + std::to_string(n);
  std::printf("radius of %.0f spacings of level %d, beta %.2f, by level%s: sigma %.3f of what was given\n",
              drop.spacings, drop.level, drop.beta, levels.c_str(), found);
  return found;
}

constexpr double within = 0.15;
sim::TargetRegion half_fine() { return {{0, 0, 1}, 1, 0, 3}; }

void drops_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  for (const int level : {0, 3}) {
    const auto method = level == 0 ? MethodKind::HiRes : MethodKind::LoRes;
    EXPECT_NEAR(tension_back({.level = level, .method = method, .backend = backend}), 1, within) << level;
  }
}
void a_drop_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(
      tension_back({.level = 3, .method = MethodKind::Ours, .targets = half_fine(), .backend = backend}), 1,
      within);
}
/// Exponents of the period: 1.5 of the radius and -0.5 of sigma, which a sigma that is measured back alike at
/// each gives: T ~ R^1.5 sigma^-0.5 sigma_back^-0.5.
void periods_follow_radius_and_tension(Backend backend) {
  NEEDS_EFFECTS;
  const double small = tension_back({.spacings = 8, .backend = backend});
  const double large = tension_back({.spacings = 16, .backend = backend});
  EXPECT_NEAR(1.5 - std::log(large / small) / 2 / std::log(2.0), 1.5, 0.1);
  const double strong = tension_back({.spacings = 8, .tension = 90, .backend = backend});
  EXPECT_NEAR(-0.5 - std::log(strong / small) / 2 / std::log(9.0), -0.5, 0.1);
}

void a_drop_that_rests_in_turns(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(tension_back({.beta = 0.67, .backend = backend}), 1, within);
}

void a_cube_becomes_a_sphere(Backend backend) {
  NEEDS_EFFECTS;
  const Drop drop{.backend = backend};
  const double half = drop.radius() * std::cbrt(pi / 6);  // of the sphere's volume
  const auto fluid = start_of(drop, [&](const Vec3d& x) {
    return std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < half;
  });
  const auto corner = [&] {
    // How far the farthest of 99 % lies, over the radius of a ball of this volume.
    const State state = fluid->read_state();
    Vec3d middle{};
    for (std::size_t k = 0; k < 3; ++k) middle[k] = mean(state, [&](const auto& p) { return place(p)[k]; });
    std::vector<double> r;
    for (const auto& p : state)
      r.push_back(std::hypot(place(p)[0] - middle[0], place(p)[1] - middle[1], place(p)[2] - middle[2]));
    std::sort(r.begin(), r.end());
    return r[r.size() - r.size() / 100 - 1] / (d * std::cbrt(3 * static_cast<double>(r.size()) / (4 * pi)));
  };
  const double before = corner();
  for (int k = 0; k < frames_of(drop); ++k) fluid->step_frame();
  const double after = corner();
  std::printf("a cube: the farthest of 99 %% lies at %.3f radii of its ball, after a period at %.3f\n",
              before, after);
  EXPECT_GT(before, 1.15);
  EXPECT_LT(after, 1);
}

/// Lone drops of every level fall at g / k at last.
void lone_drops_fall_at_their_terminal_speed(Backend backend, int level, double beta) {
  NEEDS_EFFECTS;
  constexpr double rate = 5;
  auto scene = fluid_test::tank({4, 40, 4}, {1, 1, 1});
  scene.effects = {{EffectKind::AirDrag, rate}};
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = 1000;
  State start;
  for (int k = 0; k < 9; ++k) {
    const auto x = static_cast<float>(0.8 + 1.2 * (k % 3)), z = static_cast<float>(0.8 + 1.2 * (k / 3));
    start.push_back({k, level < 0 ? k % 4 : level, x, 38, z, 0, 0, 0});
  }
  if (beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(beta) / (2 * 0.02);
  }
  options.start = start;
  const auto fluid = sim::make_simulation(scene, options);
  for (int k = 0; k < 90; ++k) fluid->step_frame();
  const State state = fluid->read_state();
  const double speed = -mean(state, [](const auto& p) { return velocity(p)[1]; });
  const double back = scene.gravity_m_s2 / speed;
  std::printf("air drag, level %d, beta %.2f: rate %.3f of what was given\n", level, beta, back / rate);
  EXPECT_NEAR(back / rate, 1, within);
}
void air_drag(Backend backend) {
  for (const int level : {0, 3, -1}) lone_drops_fall_at_their_terminal_speed(backend, level, 1);
  lone_drops_fall_at_their_terminal_speed(backend, 0, 0.67);
}

TEST(TruthTension, DropsOfOneLevelSwingWithTheirPeriod) { drops_of_one_level(Backend::Cpu); }
TEST(TruthTension, ACubeBecomesASphere) { a_cube_becomes_a_sphere(Backend::Cpu); }
TEST(TruthTension, ADropThatRestsInTurnsSwings) { a_drop_that_rests_in_turns(Backend::Cpu); }
TEST(TruthTensionSlow, ADropOfMixedLevelsSwingsWithItsPeriod) { a_drop_of_mixed_levels(Backend::Cpu); }
TEST(TruthTensionSlow, PeriodsFollowRadiusAndTension) { periods_follow_radius_and_tension(Backend::Cpu); }
TEST(TruthAirDrag, LoneDropsFallAtTheirTerminalSpeed) { air_drag(Backend::Cpu); }
TEST(TruthTensionGpu, DropsOfOneLevelSwingWithTheirPeriod) { drops_of_one_level(Backend::Cuda); }
TEST(TruthTensionGpu, ACubeBecomesASphere) { a_cube_becomes_a_sphere(Backend::Cuda); }
TEST(TruthTensionGpu, ADropThatRestsInTurnsSwings) { a_drop_that_rests_in_turns(Backend::Cuda); }
TEST(TruthTensionGpu, ADropOfMixedLevelsSwingsWithItsPeriod) { a_drop_of_mixed_levels(Backend::Cuda); }
TEST(TruthTensionGpu, PeriodsFollowRadiusAndTension) { periods_follow_radius_and_tension(Backend::Cuda); }
TEST(TruthAirDragGpu, LoneDropsFallAtTheirTerminalSpeed) { air_drag(Backend::Cuda); }

}  // namespace
