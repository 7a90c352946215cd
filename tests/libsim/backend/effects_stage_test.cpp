/// The effects' passes on small crowds and lattices.

#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// The passes of an effect; none where the program was built without.
std::vector<Stage> passes_of(EffectKind kind) {
  std::vector<Stage> out;
  for (const Stage& stage : all_stages())
    if (stage.effect == kind) out.push_back(stage);
  return out;
}
std::size_t index_of(EffectKind kind) { return static_cast<std::size_t>(kind); }
#define NEEDS_EFFECTS \
  if (!has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=OFF"

/// Particles at rest with the true neighbours within hbar and beyond, and their densities.
FluidState state_of(const std::vector<Vec4>& points, bool one_level) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.one_level = one_level;
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(points.size()));
  p.all().position.from_host(points);
  p.all().predicted.from_host(points);
  std::vector<int> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  p.all().id.from_host(id);
  p.all().level.zero();
  p.all().velocity.zero();
  std::vector<std::vector<int>> lists(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Vec3 offset = xyz(points[i]) - xyz(points[j]);
      const float hbar = (points[i].w + points[j].w) / 2;
      if (j != i && dot(offset, offset) < 1.21f * hbar * hbar) lists[i].push_back(static_cast<int>(j));
    }
  }
  state.neighbours.assign(lists);
  return state;
}

/// What one substep of an effect does to resting particles.
std::vector<Vec4> velocities_by(EffectKind kind, FluidState& state) {
  constrain_density(state, DensityView(state.particles));
  for (const Stage& stage : passes_of(kind)) stage.run(state);
  return state.particles.all().velocity.to_host();
}

double mass(const Vec4& p) { return 1000.0 * std::pow(static_cast<double>(p.w) / 2, 3); }

/// A loose ball of particles of four sizes.
std::vector<Vec4> mixed_ball() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(-0.5f, 0.5f);
  std::vector<Vec4> out;
  while (out.size() < 160) {
    const Vec3 x{at(random), at(random), at(random)};
    if (dot(x, x) > 0.25f) continue;
    const auto level = static_cast<float>(out.size() % 4);
    out.push_back(with_w(x, 0.25f * std::exp2(level / 3)));
  }
  return out;
}

SIM_TEST(Cohesion, KeepsMomentumForMixedMasses) {
  NEEDS_EFFECTS;
  auto state = state_of(mixed_ball(), false);
  state.parameters.effects.values[index_of(EffectKind::Cohesion)] = 50;
  const auto points = state.particles.all().position.to_host();
  const auto v = velocities_by(EffectKind::Cohesion, state);
  double momentum[3] = {}, exchanged = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double m = mass(points[i]);
    momentum[0] += m * static_cast<double>(v[i].x);
    momentum[1] += m * static_cast<double>(v[i].y);
    momentum[2] += m * static_cast<double>(v[i].z);
    exchanged += m * static_cast<double>(length(xyz(v[i])));
  }
  ASSERT_GT(exchanged, 1.0) << "the ball must pull itself together for the test to mean anything";
  for (const double p : momentum) EXPECT_LT(std::abs(p), 1e-6 * exchanged);
}

/// A cube of side^3 particles of spacing d, with its low corner at 0.
std::vector<Vec4> cube(int side, float d) {
  std::vector<Vec4> out;
  const auto at = [&](int k) { return d * (static_cast<float>(k) + 0.5f); };
  for (int i = 0; i < side * side * side; ++i)
    out.push_back({at(i % side), at(i / side % side), at(i / side / side), 2 * d});
  return out;
}

SIM_TEST(Cohesion, PullsAtASurfaceAndNowhereElse) {
  NEEDS_EFFECTS;
  constexpr int side = 9;
  auto state = state_of(cube(side, 0.1f), true);
  state.parameters.effects.values[index_of(EffectKind::Cohesion)] = 50;
  const auto v = velocities_by(EffectKind::Cohesion, state);
  const auto at = [&](int x, int y, int z) {
    return xyz(v[static_cast<std::size_t>((z * side + y) * side + x)]);
  };
  const float corner = length(at(0, 0, 0));
  EXPECT_GT(at(0, 0, 0).x, 0.01f);
  EXPECT_GT(at(0, 4, 4).x, 0) << "the middle of a face is pulled inwards";
  for (int x = 3; x < 6; ++x) EXPECT_LT(length(at(x, 4, 4)), 1e-4f * corner);
}

SIM_TEST(Cohesion, OneLevelAndMixedKernelsAgreeAtOneLevel) {
  NEEDS_EFFECTS;
  std::vector<Vec4> v[2];
  for (const bool one : {true, false}) {
    auto state = state_of(cube(5, 0.1f), one);
    state.parameters.effects.values[index_of(EffectKind::Cohesion)] = 50;
    v[one] = velocities_by(EffectKind::Cohesion, state);
  }
  const float scale = length(xyz(v[0][0]));
  for (std::size_t i = 0; i < v[0].size(); ++i) EXPECT_LT(length(xyz(v[0][i]) - xyz(v[1][i])), 1e-4f * scale);
}

SIM_TEST(Cohesion, APairOfTwiceTheSizeIsPulledAQuarterAsFast) {
  NEEDS_EFFECTS;
  // The force grows as h, the mass as h^3.
  float speed[2];
  for (const int scale : {1, 2}) {
    const float d = 0.1f * static_cast<float>(scale);
    auto state = state_of({{0, 0, 0, 2 * d}, {d, 0, 0, 2 * d}}, true);
    state.parameters.effects.values[index_of(EffectKind::Cohesion)] = 50;
    speed[scale - 1] = velocities_by(EffectKind::Cohesion, state)[0].x;
  }
  EXPECT_GT(speed[0], 0);
  EXPECT_NEAR(speed[1] / speed[0], 0.25f, 1e-4f);
}

/// A loose ball of particles of four sizes, each in some motion.
FluidState stirred(double nu, float steps) {
  auto state = state_of(mixed_ball(), false);
  state.finest_support = 0.25f;
  auto& effects = state.parameters.effects;
  effects.values[index_of(EffectKind::Viscosity)] = static_cast<float>(nu);
  effects.options[static_cast<std::size_t>(EffectOption::ViscositySteps)] = static_cast<double>(steps);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> any(-1, 1);
  std::vector<Vec4> v(160);
  for (Vec4& one : v) one = {any(random), any(random), any(random), 0};
  state.particles.all().velocity.from_host(v);
  return state;
}
using Vec3d = std::array<double, 3>;
/// Momentum and spin, and the sum of the particles' own.
struct Motion {
  Vec3d momentum{}, spin{};
  double all = 0;
};
Motion motion_of(const std::vector<Vec4>& points, const std::vector<Vec4>& v) {
  Motion out;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double m = mass(points[i]);
    const double x[3] = {static_cast<double>(points[i].x), static_cast<double>(points[i].y),
                         static_cast<double>(points[i].z)};
    const double u[3] = {static_cast<double>(v[i].x), static_cast<double>(v[i].y),
                         static_cast<double>(v[i].z)};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
      out.momentum[k] += m * u[k];
      out.spin[k] += m * (x[a] * u[b] - x[b] * u[a]);
    }
    out.all += m * std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  }
  return out;
}

SIM_TEST(Viscosity, KeepsMomentumAndSpinForMixedMassesHoweverFewItsSteps) {
  NEEDS_EFFECTS;
  for (const float steps : {1.0f, 3.0f, 16.0f}) {
    auto state = stirred(2, steps);
    const auto points = state.particles.all().position.to_host();
    const auto before = state.particles.all().velocity.to_host();
    const auto after = velocities_by(EffectKind::Viscosity, state);
    const Motion was = motion_of(points, before), is = motion_of(points, after);
    EXPECT_LT(is.all, 0.8 * was.all) << "it must slow the particles for the test to mean anything";
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(is.momentum[k], was.momentum[k], 1e-6 * was.all) << steps;
      EXPECT_NEAR(is.spin[k], was.spin[k], 1e-6 * was.all) << steps;
    }
  }
}

SIM_TEST(Viscosity, LeavesAloneWhatTurnsAsAWhole) {
  NEEDS_EFFECTS;
  auto state = stirred(2, 16);
  const auto points = state.particles.all().position.to_host();
  std::vector<Vec4> v;
  for (const Vec4& p : points) v.push_back({1 + 2 * p.y, -2 * p.x - 3 * p.z, 3 * p.y, 0});
  state.particles.all().velocity.from_host(v);
  const auto after = velocities_by(EffectKind::Viscosity, state);
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_LT(length(xyz(after[i]) - xyz(v[i])), 1e-5f);
}

/// The new velocities again, from the equation and in double, beside a wall.
SIM_TEST(Viscosity, SolvesItsEquation) {
  NEEDS_EFFECTS;
  constexpr double nu = 2;
  for (const double stick : {0.0, 0.5, 1.0}) {
    auto state = stirred(nu, 100);
    state.parameters.effects.options[static_cast<std::size_t>(EffectOption::ViscosityStick)] = stick;
    state.walls.planes[state.walls.count++] = {{1, 0, 0}, -0.5f};
    const auto points = state.particles.all().position.to_host();
    const auto before = state.particles.all().velocity.to_host();
    const auto after = velocities_by(EffectKind::Viscosity, state);
    const auto vector = [](const Vec4& v) {
      return Vec3d{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    };
    double worst = 0, moved = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d x = vector(points[i]), v = vector(after[i]);
      Vec3d pulled{};
      const auto pull = [&](const Vec4& other, const Vec3d& y, const Vec3d& u) {
        const double h = static_cast<double>(points[i].w + other.w) / 2;
        const Vec3d e{x[0] - y[0], x[1] - y[1], x[2] - y[2]};
        const double r2 = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
        if (r2 >= h * h || r2 == 0) return;
        const double pi2 = static_cast<double>(pi) * static_cast<double>(pi);
        const double w =
            640 / pi2 * nu / std::pow(h, 5) * std::pow(1 - r2 / (h * h), 1.5) * mass(other) / 1000;
        const double along = w * (e[0] * (v[0] - u[0]) + e[1] * (v[1] - u[1]) + e[2] * (v[2] - u[2])) / r2;
        for (std::size_t k = 0; k < 3; ++k) pulled[k] -= along * e[k];
      };
      for (std::size_t j = 0; j < points.size(); ++j) {
        const Vec3d y = vector(points[j]), u = vector(after[j]);
        if (j != i) pull(points[j], y, u);
        const double turn = 1 - 2 * stick;
        pull(points[j], {-1 - y[0], y[1], y[2]}, {-turn * u[0], turn * u[1], turn * u[2]});
      }
      const Vec3d was = vector(before[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const double dt = static_cast<double>(state.parameters.dt);
        worst = std::max(worst, std::abs(v[k] - was[k] - dt * pulled[k]));
        moved = std::max(moved, std::abs(v[k] - was[k]));
      }
    }
    EXPECT_GT(moved, 0.5);
    EXPECT_LT(worst, 1e-4 * moved) << stick;
  }
}

SIM_TEST(Viscosity, WallsHoldWhatSticksAndLetSlipWhatDoesNot) {
  NEEDS_EFFECTS;
  for (const double stick : {0.0, 1.0}) {
    auto state = state_of(cube(6, 0.1f), true);
    state.finest_support = 0.2f;
    state.walls.planes[state.walls.count++] = {{0, 1, 0}, 0};
    auto& effects = state.parameters.effects;
    effects.values[index_of(EffectKind::Viscosity)] = 0.5f;
    effects.options[static_cast<std::size_t>(EffectOption::ViscosityStick)] = stick;
    state.particles.all().velocity.from_host(std::vector<Vec4>(216, Vec4{1, 0, 0, 0}));
    const auto v = velocities_by(EffectKind::Viscosity, state);
    const auto in_row = [&](std::size_t y) { return v[3 * 36 + y * 6 + 3].x; };
    if (stick == 0) {
      for (const Vec4& one : v) EXPECT_LT(length(xyz(one) - Vec3{1, 0, 0}), 1e-6f);
    } else {
      EXPECT_LT(in_row(0), 0.9f);
      for (std::size_t y = 1; y < 4; ++y) EXPECT_GT(in_row(y), in_row(y - 1));
    }
  }
}

SIM_TEST(Viscosity, GivesTheSameBitsInEveryRun) {
  NEEDS_EFFECTS;
  const auto once = [] {
    auto state = stirred(2, 16);
    return velocities_by(EffectKind::Viscosity, state);
  };
  const auto a = once(), b = once();
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

SIM_TEST(Adhesion, TakingWaterOffAWallCostsItsShareOfTheWork) {
  NEEDS_EFFECTS;
  // Particles of spacing d in a column before the wall, lifted together: the work over the area d^2 is
  // rho_0 int s a(s) ds, whatever d: 0.17 of W is the pull's share.
  constexpr float work = 30;
  for (const float d : {0.05f, 0.1f}) {
    const float h = 2 * d;
    constexpr int steps = 400;
    std::vector<Vec4> points;
    for (int k = 0; k < steps; ++k) points.push_back({h * (static_cast<float>(k) + 0.5f) / steps, 1, 1, h});
    auto state = state_of(points, true);
    state.walls.planes[state.walls.count++] = {{1, 0, 0}, 0};
    state.parameters.effects.values[index_of(EffectKind::Adhesion)] = work;
    for (const Stage& stage : passes_of(EffectKind::Adhesion)) stage.run(state);
    const auto v = state.particles.all().velocity.to_host();
    const auto x = state.particles.all().position.to_host();
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_LE(v[k].x, 0) << "towards the wall";
      EXPECT_EQ(v[k].y, 0);
      sum -= 1000.0 * static_cast<double>(x[k].x) * static_cast<double>(v[k].x / state.parameters.dt) *
             static_cast<double>(h) / steps;
    }
    EXPECT_NEAR(sum / (0.17 * static_cast<double>(work)), 1, 0.01) << d;
  }
}

SIM_TEST(AirDrag, BrakesALoneDropAtItsRateAndWaterNotAtAll) {
  NEEDS_EFFECTS;
  for (const float h : {0.1f, 0.3f}) {
    auto points = cube(7, h / 2);
    points.push_back({20, 0, 0, h});
    auto state = state_of(points, true);
    state.parameters.effects.values[index_of(EffectKind::AirDrag)] = 3;
    state.particles.all().velocity.from_host(std::vector<Vec4>(points.size(), Vec4{0, -2, 0, 0}));
    const auto v = velocities_by(EffectKind::AirDrag, state);
    EXPECT_NEAR(v.back().y, -2 * std::exp(-3 * state.parameters.dt), 1e-5f);
    EXPECT_NEAR(v[3 + 3 * 7 + 3 * 49].y, -2, 1e-5f);
  }
}

SIM_TEST(AirDrag, LeavesOutLevelsCoarserThanItsOwnDetail) {
  NEEDS_EFFECTS;
  auto state = state_of({{0, 0, 0, 0.1f}, {20, 0, 0, 0.126f}}, false);
  state.particles.all().level.from_host({0, 1});
  state.particles.all().velocity.from_host(std::vector<Vec4>(2, Vec4{0, -2, 0, 0}));
  auto& effects = state.parameters.effects;
  effects.values[index_of(EffectKind::AirDrag)] = 3;
  effects.options[static_cast<std::size_t>(EffectOption::AirDragCoarsest)] = 0;
  const auto v = velocities_by(EffectKind::AirDrag, state);
  EXPECT_GT(v[0].y, -2);
  EXPECT_EQ(v[1].y, -2);
}

/// theta of `points` after one step of conduction.
std::vector<float> temperatures_after(FluidState& state, const std::vector<float>& before) {
  state.heat.resize(1);
  state.heat.zero();
  state.particles.all().temperature.from_host(before);
  for (const Stage& stage : passes_of(EffectKind::Heat)) stage.run(state);
  return state.particles.all().temperature.to_host();
}

SIM_TEST(Heat, StaysInTheWaterForMixedMasses) {
  NEEDS_EFFECTS;
  const auto points = mixed_ball();
  auto state = state_of(points, false);
  state.parameters.effects.values[index_of(EffectKind::Heat)] = 0.2f;
  std::vector<float> theta;
  for (const Vec4& p : points) theta.push_back(p.x > 0 ? 10.0f : 0.0f);
  const auto after = temperatures_after(state, theta);
  double held = 0, now = 0, moved = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    held += mass(points[i]) * static_cast<double>(theta[i]);
    now += mass(points[i]) * static_cast<double>(after[i]);
    moved += mass(points[i]) * std::abs(static_cast<double>(after[i] - theta[i]));
  }
  EXPECT_GT(moved, 0.01 * held);
  EXPECT_NEAR(now / held, 1, 1e-6);
}

SIM_TEST(Heat, OneLevelAndMixedKernelsAgreeAndALinearCourseStays) {
  NEEDS_EFFECTS;
  constexpr int side = 9;
  const auto points = cube(side, 0.1f);
  std::vector<float> theta;
  for (const Vec4& p : points) theta.push_back(10 * p.x);
  std::vector<float> after[2];
  for (const bool one : {true, false}) {
    auto state = state_of(points, one);
    state.parameters.effects.values[index_of(EffectKind::Heat)] = 0.1f;
    after[one] = temperatures_after(state, theta);
  }
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(after[0][i], after[1][i], 1e-5f);
  const std::size_t middle = static_cast<std::size_t>((4 * side + 4) * side + 4);
  EXPECT_NEAR(after[0][middle], theta[middle], 1e-4f);
  EXPECT_GT(after[0][0], theta[0] + 1e-3f) << "at the rim it levels out";
}

SIM_TEST(Heat, WarmWaterIsLiftedAndColdWaterIsNot) {
  NEEDS_EFFECTS;
  auto state = state_of({{0, 0, 0, 0.1f}, {5, 0, 0, 0.2f}}, false);
  auto& effects = state.parameters.effects;
  effects.values[index_of(EffectKind::Heat)] = 1e-6f;
  effects.options[static_cast<std::size_t>(EffectOption::HeatExpansion)] = 0.01;
  temperatures_after(state, {10, 0});
  const auto v = state.particles.all().velocity.to_host();
  EXPECT_NEAR(v[0].y, 9.81f * 0.1f * state.parameters.dt, 1e-6f);
  EXPECT_EQ(v[1].y, 0);
  effects.options[static_cast<std::size_t>(EffectOption::HeatExpansion)] = 0;
  temperatures_after(state, {10, 0});
  EXPECT_EQ(state.particles.all().velocity.to_host()[0].y, v[0].y);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
