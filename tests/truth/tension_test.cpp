/// Effects recovered from the motion: tension from the period of drops without gravity (Rayleigh 1879), air
/// drag from the terminal speed of drops.

#include "tests/common/needs_effects.hpp"
#include "tests/truth/drop_scene.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

std::array<double, 3> half_axes(const State& state) {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double middle = mean(state, [&](const auto& p) { return place(p)[k]; });
    out[k] = std::sqrt(5 * mean(state, [&](const auto& p) { return std::pow(place(p)[k] - middle, 2); }));
  }
  return out;
}
/// Logarithm of the half axis along y over the geometric mean of the three half axes.
double stretch(const State& state) {
  const auto a = half_axes(state);
  return std::log(a[1] / std::sqrt(a[0] * a[2])) * 2 / 3;
}

/// The tension sigma that follows from the frequency and the decay rate gamma of the best-fitting damped
/// oscillation, over that of the scene: a drop oscillates at sqrt(omega_0^2 - gamma^2).
double tension_back(const Drop& drop) {
  const auto fluid = start_of(drop, in_ball(drop));
  const int frames = drop.frames();
  for (int k = 0; k < frames / 5; ++k) fluid->step_frame();
  const double omega = 2 * pi / drop.period();
  State state = fluid->read_state();
  const double middle = drop.tank() / 2;
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
  std::string levels;
  for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  std::printf("radius of %.0f spacings of level %d, by level%s: sigma %.3f of what was given\n",
              drop.spacings, drop.level, levels.c_str(), found);
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
/// Exponents of the period: 1.5 for the radius and -0.5 for sigma. They follow if the recovered sigma is the
/// same for each: T ~ R^1.5 sigma^-0.5 sigma_back^-0.5.
void periods_follow_radius_and_tension(Backend backend) {
  NEEDS_EFFECTS;
  const double small = tension_back({.spacings = 8, .backend = backend});
  const double large = tension_back({.spacings = 16, .backend = backend});
  EXPECT_NEAR(1.5 - std::log(large / small) / 2 / std::log(2.0), 1.5, 0.1);
  const double strong = tension_back({.spacings = 8, .tension = 90, .backend = backend});
  EXPECT_NEAR(-0.5 - std::log(strong / small) / 2 / std::log(9.0), -0.5, 0.1);
}

void a_cube_becomes_a_sphere(Backend backend) {
  NEEDS_EFFECTS;
  const Drop drop{.backend = backend};
  const double half = drop.radius() * std::cbrt(pi / 6);  // same volume as the sphere
  const auto fluid = start_of(drop, [&](const Vec3d& x) {
    return std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < half;
  });
  const auto corner = [&] {
    // 99th percentile of the distance from the middle, over the radius of a ball of this volume.
    const State state = fluid->read_state();
    Vec3d middle{};
    for (std::size_t k = 0; k < 3; ++k) middle[k] = mean(state, [&](const auto& p) { return place(p)[k]; });
    std::vector<double> r;
    for (const auto& p : state)
      r.push_back(std::hypot(place(p)[0] - middle[0], place(p)[1] - middle[1], place(p)[2] - middle[2]));
    std::sort(r.begin(), r.end());
    return r[r.size() - r.size() / 100 - 1] /
           (drop.spacing() * std::cbrt(3 * static_cast<double>(r.size()) / (4 * pi)));
  };
  const double before = corner();
  for (int k = 0; k < drop.frames(); ++k) fluid->step_frame();
  const double after = corner();
  std::printf("a cube: the farthest of 99 %% lies at %.3f radii of its ball, after a period at %.3f\n",
              before, after);
  EXPECT_GT(before, 1.15);
  EXPECT_LT(after, 1);
}

/// Lone drops of every level reach the terminal speed g / k.
void lone_drops_fall_at_their_terminal_speed(Backend backend, int level) {
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
  options.start = start;
  const auto fluid = sim::make_simulation(scene, options);
  for (int k = 0; k < 90; ++k) fluid->step_frame();
  const State state = fluid->read_state();
  const double speed = -mean(state, [](const auto& p) { return velocity(p)[1]; });
  const double back = scene.gravity_m_s2.size() / speed;
  std::printf("air drag, level %d: rate %.3f of what was given\n", level, back / rate);
  EXPECT_NEAR(back / rate, 1, within);
}
void air_drag(Backend backend) {
  for (const int level : {0, 3, -1}) lone_drops_fall_at_their_terminal_speed(backend, level);
}

TEST(TruthTension, DropsOfOneLevelSwingWithTheirPeriod) { drops_of_one_level(Backend::Cpu); }
TEST(TruthTension, ACubeBecomesASphere) { a_cube_becomes_a_sphere(Backend::Cpu); }
TEST(TruthTensionSlow, ADropOfMixedLevelsSwingsWithItsPeriod) { a_drop_of_mixed_levels(Backend::Cpu); }
TEST(TruthTensionSlow, PeriodsFollowRadiusAndTension) { periods_follow_radius_and_tension(Backend::Cpu); }
TEST(TruthAirDrag, LoneDropsFallAtTheirTerminalSpeed) { air_drag(Backend::Cpu); }
TEST(TruthTensionGpu, DropsOfOneLevelSwingWithTheirPeriod) { drops_of_one_level(Backend::Cuda); }
TEST(TruthTensionGpu, ACubeBecomesASphere) { a_cube_becomes_a_sphere(Backend::Cuda); }
TEST(TruthTensionGpu, ADropOfMixedLevelsSwingsWithItsPeriod) { a_drop_of_mixed_levels(Backend::Cuda); }
TEST(TruthTensionGpu, PeriodsFollowRadiusAndTension) { periods_follow_radius_and_tension(Backend::Cuda); }
TEST(TruthAirDragGpu, LoneDropsFallAtTheirTerminalSpeed) { air_drag(Backend::Cuda); }

}  // namespace
