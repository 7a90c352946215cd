/// Friction's pass beside walls and obstacles.

#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr float drag = 0.7f;

/// Particles with velocity v over the floor y = 0.
FluidState over_a_floor(const std::vector<Vec4>& points, Vec4 v) {
  auto state = state_of(points, true);
  state.walls.planes[state.walls.count++] = {{0, 1, 0}, 0};
  state.parameters.effects.values[index_of(EffectKind::Friction)] = drag;
  state.particles.all().velocity.from_host(std::vector<Vec4>(points.size(), v));
  return state;
}

SIM_TEST(Friction, SlowsWhatSlidesWithinASpacingOfAWallAtItsRate) {
  NEEDS_EFFECTS;
  for (const float d : {0.05f, 0.1f}) {
    auto state = over_a_floor({{0, 0.9f * d, 0, 2 * d}, {9, 1.1f * d, 0, 2 * d}}, {3, -2, 1, 0});
    const auto v = velocities_by(EffectKind::Friction, state);
    const float kept = 1 - drag * state.parameters.dt / d;
    EXPECT_NEAR(v[0].x, 3 * kept, 1e-5f);
    EXPECT_EQ(v[0].y, -2);
    EXPECT_NEAR(v[0].z, kept, 1e-5f);
    EXPECT_EQ(v[1].x, 3);
    EXPECT_EQ(v[1].z, 1);
  }
}

SIM_TEST(Friction, AnyLatticeFeelsTheSameStress) {
  NEEDS_EFFECTS;
  // A column of a lattice loses the momentum rho_0 c u dt per area d^2, with c = `drag` and its speed u along
  // the floor.
  for (const float d : {0.05f, 0.1f}) {
    for (const float lowest : {0.1f, 0.5f, 0.9f}) {
      std::vector<Vec4> points;
      for (int k = 0; k < 4; ++k) points.push_back({0, d * (lowest + static_cast<float>(k)), 0, 2 * d});
      auto state = over_a_floor(points, {1, 0, 0, 0});
      const auto v = velocities_by(EffectKind::Friction, state);
      double lost = 0;
      for (std::size_t i = 0; i < v.size(); ++i) lost += mass(points[i]) * (1 - static_cast<double>(v[i].x));
      const double stress = lost / static_cast<double>(d * d * state.parameters.dt);
      EXPECT_NEAR(stress / (1000 * static_cast<double>(drag)), 1, 0.05) << d << ", lowest at " << lowest;
    }
  }
}

SIM_TEST(Friction, ALargeOneHoldsAndTurnsNothingBack) {
  NEEDS_EFFECTS;
  auto state = over_a_floor({{0, 0.01f, 0, 0.1f}}, {3, 0, 0, 0});
  state.parameters.effects.values[index_of(EffectKind::Friction)] = 1e6f;
  EXPECT_EQ(velocities_by(EffectKind::Friction, state)[0].x, 0);
}

SIM_TEST(Friction, AnOpeningHasNone) {
  NEEDS_EFFECTS;
  auto state = over_a_floor({{0, 0.01f, 0, 0.1f}, {5, 0.01f, 0, 0.1f}}, {3, 0, 0, 0});
  state.walls.openings[state.walls.opening_count++] = {0, {-1, -1, -1}, {1, 1, 1}};
  const auto v = velocities_by(EffectKind::Friction, state);
  EXPECT_EQ(v[0].x, 3);
  EXPECT_LT(v[1].x, 3);
}

Body body_of(Vec3 half, float radius) {
  Body out{};
  out.half = half;
  out.radius = radius;
  out.turn = {0, 0, 0, 1};
  return out;
}

/// Momentum that random particles round a body lose, over rho_0 c u dt (c: coefficient of friction, u: their
/// velocity), which is the area of the faces along u.
double face_of(const Body& body, float d, float reach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> at(-reach, reach);
  std::vector<Vec4> points;
  while (points.size() < 40'000) {
    const Vec3 x{at(random), at(random), at(random)};
    if (body.distance(x) > 0) points.push_back(with_w(x, 2 * d));
  }
  FluidState state;
  state.particles.allocate(all_columns(), static_cast<int>(points.size()));
  state.particles.all().position.from_host(points);
  // Velocity along y; the body does not turn.
  state.particles.all().velocity.from_host(std::vector<Vec4>(points.size(), Vec4{0, 1, 0, 0}));
  state.obstacles.bodies.from_host({body});
  state.parameters.effects.values[index_of(EffectKind::Friction)] = 1e-3f;
  for (const Stage& stage : passes_of(EffectKind::Friction)) stage.run(state);
  double lost = 0;
  for (const Vec4& v : state.particles.all().velocity.to_host()) lost += 1 - static_cast<double>(v.y);
  const double whole = 8 * std::pow(static_cast<double>(reach), 3);
  // The particles fill the space outside the body.
  double outside = 0;
  std::mt19937 again(6);
  constexpr int tries = 100'000;
  for (int k = 0; k < tries; ++k) outside += body.distance({at(again), at(again), at(again)}) > 0;
  return lost / static_cast<double>(points.size()) * whole * outside / tries /
         static_cast<double>(1e-3f * state.parameters.dt);
}

SIM_TEST(Friction, OfRoundObstaclesIsThatOfTheirFaces) {
  NEEDS_EFFECTS;
  // A sphere's share along one direction is 1 - n_y^2, two thirds on average.
  const Body ball = body_of({0, 0, 0}, 0.3f);
  EXPECT_NEAR(face_of(ball, 0.1f, 0.5f) / (4 * 3.14159 * 0.09 * 2 / 3), 1, 0.03);
  const Body capsule = body_of({0, 0.2f, 0}, 0.2f);
  EXPECT_NEAR(face_of(capsule, 0.1f, 0.6f) / (2 * 3.14159 * 0.2 * (0.4 + 0.4 * 2 / 3)), 1, 0.03);
  const Body box = body_of({0.2f, 0.2f, 0.2f}, 0);
  EXPECT_GT(face_of(box, 0.02f, 0.3f) / (4 * 0.16), 0.97);
}

SIM_TEST(Friction, WaterThatGoesWithAnObstacleFeelsNone) {
  NEEDS_EFFECTS;
  Body ball = body_of({0, 0, 0}, 0.3f);
  ball.velocity = {1, 0, 2};
  ball.spin = {0, 3, 0};
  const Vec3 place{0.32f, 0, 0};
  auto state = state_of({with_w(place, 0.1f), {0, 0, 0.32f, 0.1f}}, true);
  state.obstacles.bodies.from_host({ball});
  state.parameters.effects.values[index_of(EffectKind::Friction)] = 1;
  const Vec3 with = ball.velocity_at(place);
  state.particles.all().velocity.from_host({with_w(with, 0), {0, 0, 0, 0}});
  for (const Stage& stage : passes_of(EffectKind::Friction)) stage.run(state);
  const auto v = state.particles.all().velocity.to_host();
  EXPECT_LT(length(xyz(v[0]) - with), 1e-6f);
  EXPECT_GT(v[1].x, 0) << "water at rest is dragged along";
  EXPECT_EQ(v[1].z, 0) << "and not pushed";
}

/// A ball receives the momentum that the water loses, and a light free ball gets no faster than the water.
SIM_TEST(Friction, ABodyIsToldWhatTheWaterLoses) {
  NEEDS_EFFECTS;
  constexpr float d = 0.1f;
  for (const float units : {0.0f, 0.5f, 100.0f}) {
    for (const float c : {0.1f, 1e3f}) {
      std::vector<Vec4> points = cube(8, d);
      for (Vec4& p : points) p = {p.x - 4 * d, p.y - 4 * d, p.z - 4 * d, p.w};
      const Body ball = body_of({0, 0, 0}, 0.3f);
      std::erase_if(points, [&](const Vec4& p) { return ball.distance(xyz(p)) < 0; });
      auto state = state_of(points, true);
      state.finest_support = 2 * d;
      state.obstacles.bodies.from_host({ball});
      state.obstacles.sums.resize(2);
      state.obstacles.sums.zero();
      if (units > 0) {
        FreeBody free{};
        free.mass = units;
        free.inertia = (0.4f * 0.09f * units) * Vec3{1, 1, 1};
        state.obstacles.free.from_host({free});
      }
      state.parameters.effects.values[index_of(EffectKind::Friction)] = c;
      std::vector<Vec4> before;
      for (const Vec4& p : points) before.push_back({1 - p.z, 0, p.x, 0});
      state.particles.all().velocity.from_host(before);
      for (const Stage& stage : passes_of(EffectKind::Friction)) stage.run(state);
      const auto after = state.particles.all().velocity.to_host();
      Vec3 lost{}, spin{};
      for (std::size_t i = 0; i < points.size(); ++i) {
        lost += xyz(before[i]) - xyz(after[i]);
        spin += cross(xyz(points[i]), xyz(before[i]) - xyz(after[i]));
      }
      const BodySum told = state.obstacles.sums.to_host()[1];
      const float dt = state.parameters.dt;
      EXPECT_LT(length((-1 / dt) * told.push.value() - lost), 1e-4f * length(lost));
      EXPECT_LT(length((-1 / dt) * told.moment.value() - spin), 1e-4f * length(spin));
      ASSERT_GT(lost.x, 0);
      ASSERT_LT(spin.y, 0);
      if (units == 0) continue;
      EXPECT_LE(lost.x / units, 1) << units << " at " << c;
      EXPECT_LE(-spin.y / (0.4f * 0.09f * units), 1) << units << " at " << c;
    }
  }
}

}  // namespace
}  // namespace sim::SIM_BACKEND
