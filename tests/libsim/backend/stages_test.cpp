#include "libsim/solver/stages/stages.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include "libsim/solver/schedule.hpp"
#include "stats/base/error.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// A state of resting particles, without lists.
FluidState resting(const std::vector<Vec4>& points) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(points.size()));
  p.all().ease.from_host(std::vector<float>(points.size(), 1));
  p.all().position.from_host(points);
  p.all().predicted.from_host(points);
  std::vector<int> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  p.all().id.from_host(id);
  p.all().level.zero();
  p.all().velocity.zero();
  return state;
}

/// A state whose neighbour lists hold all pairs, at any distance.
FluidState state_of(const std::vector<Vec4>& points, bool one_level) {
  FluidState state = resting(points);
  state.one_level = one_level;
  std::vector<std::vector<int>> lists(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != i) lists[i].push_back(static_cast<int>(j));
    }
  }
  state.neighbours.assign(lists);
  return state;
}

/// A state of one level with neighbour lists from the grid.
FluidState listed(const std::vector<Vec4>& points) {
  FluidState state = resting(points);
  state.lightest_support = points.empty() ? 1 : points[0].w;
  do {
    find_neighbours(state, NeighboursView(state.particles));
  } while (state.neighbours.grow());
  return state;
}

std::vector<Vec4> crowd(int n, unsigned seed, bool mixed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(0, 0.5f);
  std::vector<Vec4> out;
  for (int i = 0; i < n; ++i) {
    const float level = mixed ? static_cast<float>(i % 4) : 0;
    out.push_back({at(random), at(random), at(random), 0.3f * std::exp2(level / 3)});
  }
  return out;
}

double mass(const Vec4& p) { return 1000.0 * std::pow(static_cast<double>(p.w) / 2, 3); }

SIM_TEST(Displacement, KeepsTheCentreOfMassForMixedMasses) {
  for (const bool tensile : {false, true}) {
    auto state = state_of(crowd(120, 11, true), false);
    state.parameters.tensile = tensile ? 0.01f : 0;
    const auto before = state.particles.all().predicted.to_host();
    density_stage().run(state);
    displacement_stage().run(state);
    const auto after = state.particles.all().predicted.to_host();
    double moment[3] = {};
    double moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double d[3] = {static_cast<double>(after[i].x) - static_cast<double>(before[i].x),
                           static_cast<double>(after[i].y) - static_cast<double>(before[i].y),
                           static_cast<double>(after[i].z) - static_cast<double>(before[i].z)};
      for (int k = 0; k < 3; ++k) {
        moment[k] += mass(before[i]) * d[k];
        moved += mass(before[i]) * std::abs(d[k]);
      }
    }
    ASSERT_GT(moved, 1.0) << "the crowd must be pushed apart for the test to mean anything";
    for (const double m : moment) EXPECT_LT(std::abs(m), 1e-6 * moved);
  }
}

SIM_TEST(Xsph, KeepsMomentumForMixedMasses) {
  auto state = state_of(crowd(120, 5, true), false);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> speed(-2, 2);
  std::vector<Vec4> velocity;
  for (int i = 0; i < 120; ++i) velocity.push_back({speed(random), speed(random), speed(random), 0});
  state.particles.all().velocity.from_host(velocity);
  state.parameters.viscosity = 0.1f;
  density_stage().run(state);
  xsph_stage().run(state);
  const auto points = state.particles.all().position.to_host();
  const auto after = state.particles.all().velocity.to_host();
  double momentum = 0;
  double exchanged = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const double change = static_cast<double>(after[i].x) - static_cast<double>(velocity[i].x);
    momentum += mass(points[i]) * change;
    exchanged += mass(points[i]) * std::abs(change);
  }
  ASSERT_GT(exchanged, 1.0);
  EXPECT_LT(std::abs(momentum), 1e-6 * exchanged);
}

/// Fraction of a shear wave v_x = sin(k y) that remains in the middle of a lattice after `substeps` of dt.
double shear_left(float h, float viscosity, float dt, int substeps) {
  constexpr int side = 18;
  const float spacing = h / 2;
  const float wave = 2 * pi / (side * spacing / 2);
  std::vector<Vec4> points, velocity;
  for (int i = 0; i < side * side * side; ++i) {
    const auto at = [&](int k) { return spacing * (static_cast<float>(k) + 0.5f); };
    points.push_back({at(i % side), at(i / side / side), at(i / side % side), h});
  }
  FluidState state = listed(points);
  for (const Vec4& p : state.particles.all().position.to_host())
    velocity.push_back({sinf(wave * p.y), 0, 0, 0});
  state.particles.all().velocity.from_host(velocity);
  state.parameters.viscosity = viscosity;
  state.parameters.dt = dt;
  state.particles.all().density.from_host(std::vector<float>(points.size(), 1));
  for (int k = 0; k < substeps; ++k) xsph_stage().run(state);
  const auto after = state.particles.all().velocity.to_host();
  const auto where = state.particles.all().position.to_host();
  double there = 0, all = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Vec4 p = where[i];
    const float low = 6 * spacing, high = (side - 6) * spacing;
    if (p.x < low || p.x > high || p.y < low || p.y > high || p.z < low || p.z > high) continue;
    const double s = std::sin(static_cast<double>(wave * p.y));
    there += static_cast<double>(after[i].x) * s;
    all += s * s;
  }
  return there / all;
}

SIM_TEST(Xsph, IsAKinematicViscosityAtEverySizeAndTimeStep) {
  // Decay exp(-nu k^2 t) with the same nu for every support and number of substeps; k h = 2 pi 2 / 9.
  const float h = 0.3f;
  const double k = 2 * 3.14159265 / (9 * static_cast<double>(h) / 2);
  const double t = 0.1, nu = 0.02;
  const double expected = nu * k * k * t;
  for (const int substeps : {6, 12, 24}) {
    const double left = shear_left(h, static_cast<float>(nu), static_cast<float>(t / substeps), substeps);
    EXPECT_NEAR(-std::log(left) / expected, 1, 0.12) << substeps;
  }
  // Twice the size: a quarter of k^2.
  const double left = shear_left(2 * h, static_cast<float>(nu), static_cast<float>(t / 12), 12);
  EXPECT_NEAR(-std::log(left) / (expected / 4), 1, 0.12);
}

/// Mean degree of rest of water that flows at `flow` m/s for a second and then at `later` m/s for half a
/// second, while each particle also jitters at 0.5 m/s along each axis with a new direction in each substep.
double rest_in_jitter(float flow, float later) {
  std::vector<Vec4> points;
  constexpr int side = 10;
  constexpr float h = 0.14f;
  for (int i = 0; i < side * side * side; ++i)
    points.push_back({h / 2 * static_cast<float>(i % side), h / 2 * static_cast<float>(i / side % side),
                      h / 2 * static_cast<float>(i / side / side), h});
  FluidState state = listed(points);
  state.one_level = false;
  state.finest_support = h;
  state.parameters.dt = 1.0f / 240;
  state.parameters.most_speed = 1000;
  auto& p = state.particles.all();
  p.density.from_host(std::vector<float>(points.size(), 1));
  p.ease.from_host(std::vector<float>(points.size(), 1));
  p.drift.zero();
  std::mt19937 random(4);
  std::bernoulli_distribution forward;
  const auto jitter = [&] { return forward(random) ? 0.5f : -0.5f; };
  std::vector<Vec4> velocity(points.size());
  for (int substep = 0; substep < 360; ++substep) {
    for (Vec4& v : velocity) v = {(substep < 240 ? flow : later) + jitter(), jitter(), jitter(), 0};
    p.velocity.from_host(velocity);
    p.predicted_next.zero();
    xsph_of_levels_stage().run(state);
  }
  p.predicted.from_host(p.position.to_host());
  velocity_stage().run(state);
  double sum = 0;
  for (const Vec4& v : p.velocity.to_host()) sum += static_cast<double>(v.w);
  return sum / static_cast<double>(points.size());
}
SIM_TEST(Drift, TellsMotionFromJitterAndLastsWhileAWaveTurns) {
  EXPECT_GT(rest_in_jitter(0, 0), 0.9) << "jitter has no mean";
  EXPECT_LT(rest_in_jitter(0.2f, 0.2f), 0.01) << "the water flows";
  EXPECT_LT(rest_in_jitter(0.2f, 0), 0.01) << "it flowed half a second ago";
  EXPECT_GT(rest_in_jitter(0.02f, 0.02f), 0.5) << "it flows more slowly than the limit";
}

SIM_TEST(Density, OneLevelAndMixedKernelsAgreeAtOneLevel) {
  auto one = state_of(crowd(100, 9, false), true);
  auto mixed = state_of(crowd(100, 9, false), false);
  for (auto* state : {&one, &mixed}) {
    density_stage().run(*state);
    displacement_stage().run(*state);
  }
  const auto a = one.particles.all().predicted.to_host();
  const auto b = mixed.particles.all().predicted.to_host();
  const auto lambda_a = one.particles.all().lambda.to_host();
  const auto lambda_b = mixed.particles.all().lambda.to_host();
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(lambda_a[i], lambda_b[i], 1e-4f * std::abs(lambda_a[i]));
    EXPECT_NEAR(a[i].x, b[i].x, 1e-5f);
    EXPECT_NEAR(a[i].y, b[i].y, 1e-5f);
  }
}

SIM_TEST(Density, LatticeHasTheRestDensity) {
  std::vector<Vec4> points;
  const float d = 0.15f;
  for (int i = 0; i < 343; ++i) {
    points.push_back({d * static_cast<float>(i % 7), d * static_cast<float>(i / 7 % 7),
                      d * static_cast<float>(i / 49), 2 * d});
  }
  auto state = state_of(points, true);
  density_stage().run(state);
  EXPECT_NEAR(state.particles.all().density.to_host()[3 + 3 * 7 + 3 * 49], 1, 1e-5);
}

SIM_TEST(Density, AWallMakesUpForWhatIsNotThere) {
  constexpr float d = 0.15f;
  std::vector<Vec4> points;
  for (int i = 0; i < 343; ++i) {
    points.push_back({d * (static_cast<float>(i % 7) + 0.5f), d * static_cast<float>(i / 7 % 7),
                      d * static_cast<float>(i / 49), 2 * d});
  }
  auto state = state_of(points, true);
  state.walls.planes[state.walls.count++] = {{1, 0, 0}, 0};
  density_stage().run(state);
  EXPECT_NEAR(state.particles.all().density.to_host()[0 + 3 * 7 + 3 * 49], 1, 0.03);
}

SIM_TEST(Density, ACrowdTwiceAsLargeMovesTwiceAsFar) {
  std::vector<Vec4> moved[2];
  for (const int scale : {1, 2}) {
    const auto by = static_cast<float>(scale);
    auto points = crowd(100, 9, false);
    for (auto& p : points) p = {by * p.x, by * p.y, by * p.z, by * p.w};
    auto state = state_of(points, true);
    state.parameters.relaxation = 1;
    density_stage().run(state);
    displacement_stage().run(state);
    moved[scale - 1] = state.particles.all().predicted.to_host();
  }
  for (std::size_t i = 0; i < 100; ++i) EXPECT_NEAR(2 * moved[0][i].x, moved[1][i].x, 1e-5f);
}

SIM_TEST(Density, LonelyParticleIsLeftAlone) {
  auto state = state_of({{0, 0, 0, 0.3f}}, true);
  density_stage().run(state);
  displacement_stage().run(state);
  EXPECT_EQ(state.particles.all().lambda.to_host()[0], 0);
  EXPECT_EQ(state.particles.all().predicted.to_host()[0].x, 0);
}

SIM_TEST(Walls, MakeUpHalvesQuartersAndCorners) {
  Walls walls{};
  const Vec3 normals[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const float missing[3] = {0.5f, 0.75f, 0.875f};
  for (int k = 0; k < 3; ++k) {
    walls.planes[walls.count++] = {normals[k], 0};
    Vec3 gradient;
    EXPECT_NEAR(walls.missing({0, 0, 0}, 0.3f, gradient), missing[k], 1e-6f);
  }
  Vec3 gradient;
  EXPECT_EQ(walls.missing({1, 1, 1}, 0.3f, gradient), 0);
  EXPECT_EQ(gradient.x, 0);
}

SIM_TEST(Walls, ShareIsTheKernelsIntegralBehindThePlane) {
  // Numeric integral of poly6 over discs behind the plane, h = 1; and of the spiky kernel's slope along the
  // normal.
  for (const double q : {0.0, 0.2, 0.5, 0.8}) {
    double behind = 0;
    double slope = 0;
    constexpr int steps = 400;
    for (int i = 0; i < steps; ++i) {
      const double z = q + (1 - q) * (i + 0.5) / steps;
      for (int k = 0; k < steps; ++k) {
        const double s = (k + 0.5) / steps;
        const double r2 = z * z + s * s;
        if (r2 >= 1) continue;
        const double ring = 2 * 3.14159265358979 * s / steps * (1 - q) / steps;
        behind += ring * 315 / (64 * 3.14159265358979) * std::pow(1 - r2, 3);
        slope += ring * 45 / 3.14159265358979 * std::pow(1 - std::sqrt(r2), 2) * z / std::sqrt(r2);
      }
    }
    EXPECT_NEAR(Walls::behind(static_cast<float>(q)), behind, 2e-4);
    EXPECT_NEAR(Walls::slope(static_cast<float>(q)), slope, 2e-3);
  }
}

SIM_TEST(PartingDirection, IsAUnitVectorAndAntisymmetric) {
  for (int i = 0; i < 50; ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec3 a = parting_direction(i, j);
      const Vec3 b = parting_direction(j, i);
      EXPECT_NEAR(length(a), 1, 1e-5f);
      EXPECT_EQ(length(a + b), 0);
    }
  }
}

SIM_TEST(Schedule, LeavesOutWhatNothingCallsFor) {
  Demand demand;
  demand.parameters.viscosity = 0;
  EXPECT_NE(compile_schedule(demand).explanation.find("substep end  xsph"), std::string::npos)
      << "still water";
  demand.parameters.gravity = 0;
  EXPECT_NE(compile_schedule(demand).explanation.find("-  xsph"), std::string::npos) << "nothing rests";
  demand.parameters.gravity = 9.81f;
  demand.parameters.still_speed = 0;
  const auto without = compile_schedule(demand);
  EXPECT_EQ(without.explanation.find("substep end  xsph"), std::string::npos);
  EXPECT_NE(without.explanation.find("-  xsph"), std::string::npos);
  EXPECT_TRUE(without.columns.has(Column::VelocityNext)) << "pre-stabilisation needs it";
  demand.parameters.coarse_cycles = 0;
  EXPECT_FALSE(compile_schedule(demand).columns.has(Column::VelocityNext));
  demand.parameters.viscosity = 0.1f;
  demand.settling = true;
  const auto with = compile_schedule(demand);
  EXPECT_TRUE(with.columns.has(Column::VelocityNext));
  EXPECT_EQ(with.frame_end.size(), 1u);
  EXPECT_EQ(with.frame_start.size(), 0u);
  EXPECT_NE(with.explanation.find("-  nozzle"), std::string::npos);
  EXPECT_EQ(without.frame_end.size(), 0u);
}

SIM_TEST(Schedule, RefusesAPassThatReadsWhatNobodyWrote) {
  EXPECT_THROW(compile_schedule({}, {predict_stage(), density_stage()}), base::Error);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
