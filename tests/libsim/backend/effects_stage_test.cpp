/// The effects' passes on small sets of particles and lattices; viscosity_stage_test.cpp tests viscosity.

#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

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

/// Adhesion with this work and a tension, on particles before a wall at x = 0.
struct BesideAWall {
  float tension, work;
  float density = 1, normal = 0;  ///< of all particles; the normal along x

  std::vector<Vec4> velocities(const std::vector<Vec4>& points, float& dt) const {
    auto state = state_of(points, true);
    dt = state.parameters.dt;
    state.walls.planes[state.walls.count++] = {{1, 0, 0}, 0};
    state.parameters.effects.values[index_of(EffectKind::Cohesion)] = tension;
    state.parameters.effects.values[index_of(EffectKind::Adhesion)] = work;
    state.particles.all().density.from_host(std::vector<float>(points.size(), density));
    state.particles.all().normal.from_host(std::vector<Vec4>(points.size(), Vec4{normal, 0.3f, 0, 0}));
    for (const Stage& stage : passes_of(EffectKind::Adhesion)) stage.run(state);
    return state.particles.all().velocity.to_host();
  }
};

SIM_TEST(Adhesion, TakingWaterOffAWallCostsItsShareOfTheWorkBeyondTension) {
  NEEDS_EFFECTS;
  // Particles of spacing d in a column before the wall, lifted together: the work over the area d^2 is rho_0
  // int s a(s) ds for every d, with the acceleration a at the distance s. The adhesion pull does 0.75 of the
  // work minus the tension.
  const BesideAWall wall{.tension = 20, .work = 50};
  for (const float d : {0.05f, 0.1f}) {
    const float h = 2 * d;
    constexpr int steps = 400;
    std::vector<Vec4> x;
    for (int k = 0; k < steps; ++k) x.push_back({h * (static_cast<float>(k) + 0.5f) / steps, 1, 1, h});
    float dt = 0;
    const auto v = wall.velocities(x, dt);
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_LE(v[k].x, 0) << "towards the wall";
      EXPECT_EQ(v[k].y, 0);
      sum -= 1000.0 * static_cast<double>(x[k].x) * static_cast<double>(v[k].x / dt) *
             static_cast<double>(h) / steps;
    }
    EXPECT_NEAR(sum / (0.75 * 30), 1, 0.01) << d;
  }
}

/// The wall's pull must be the pair force of Cohesion summed over still water behind the wall. `skin` is the
/// share of the attraction at the particle's density, 0.9 rho_0; for the water behind the wall the share and
/// the surface normal are 0.
SIM_TEST(Adhesion, AWallPullsAsTheStillWaterBehindItWould) {
  NEEDS_EFFECTS;
  constexpr double h = 0.2, skin = 0.5, normal = -0.7, tension = 20;
  for (const double q : {0.1, 0.45, 0.8}) {
    constexpr int steps = 60;
    constexpr double cell = h / steps;
    double force = 0;  // over the tension and the particle's volume
    for (int a = 0; a < steps; ++a) {
      for (int b = -steps; b < steps; ++b) {
        for (int c = -steps; c < steps; ++c) {
          const double x = q * h + (a + 0.5) * cell, y = (b + 0.5) * cell, z = (c + 0.5) * cell;
          const double t = h * h - x * x - y * y - z * z;
          if (t <= 0) continue;
          const double w = 315 / (64 * 3.14159265 * std::pow(h, 9)) * t * cell * cell * cell;
          force += 12 / h * skin * -6 * w * t * x - 2.6 * (24 * w * x * x - 6 * w * t) * normal;
        }
      }
    }
    for (const double share : {1.0, 0.5}) {
      const BesideAWall wall{.tension = tension,
                             .work = static_cast<float>(share * tension),
                             .density = 0.9f,
                             .normal = static_cast<float>(normal)};
      float dt = 0;
      const auto v = wall.velocities({{static_cast<float>(q * h), 1, 1, static_cast<float>(h)}}, dt);
      const double expected = share * share * tension / 1000 * force;
      EXPECT_NEAR(static_cast<double>(v[0].x / dt), expected, 0.02 * std::abs(expected)) << q;
    }
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

/// Temperatures of the particles above the reference, K, after one step of conduction.
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

SIM_TEST(Heat, WarmWaterRisesAndColdWaterSinksAboutTheirMeanByMass) {
  NEEDS_EFFECTS;
  auto state = state_of({{0, 0, 0, 0.1f}, {5, 0, 0, 0.2f}}, false);
  state.particles.all().level.from_host({0, 3});
  auto& effects = state.parameters.effects;
  const auto set = [&](EffectOption option, double value) {
    effects.options[static_cast<std::size_t>(option)] = value;
  };
  effects.values[index_of(EffectKind::Heat)] = 1e-6f;
  set(EffectOption::HeatExpansion, 0.01);
  temperatures_after(state, {9, 0});
  // The second is eight times as heavy: the mean is 1 K above the reference.
  const auto v = state.particles.all().velocity.to_host();
  EXPECT_NEAR(v[0].y, 9.81f * 0.08f * state.parameters.dt, 1e-6f);
  EXPECT_NEAR(v[1].y, -9.81f * 0.01f * state.parameters.dt, 1e-6f);
  const auto stays = [&](const std::vector<float>& temperatures) {
    temperatures_after(state, temperatures);
    const auto now = state.particles.all().velocity.to_host();
    EXPECT_EQ(now[0].y, v[0].y);
    EXPECT_EQ(now[1].y, v[1].y);
  };
  stays({500, 500});
  set(EffectOption::HeatCoarsest, 0);
  stays({9, 0});  // the only one that takes part has the mean temperature
  set(EffectOption::HeatCoarsest, 3);
  set(EffectOption::HeatExpansion, 0);
  stays({9, 0});
}

}  // namespace
}  // namespace sim::SIM_BACKEND
