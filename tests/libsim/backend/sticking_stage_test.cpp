/// The effects viscosity and adhesion at obstacles, on small sets of particles.

#include <array>
#include <cstring>

#include "libsim/solver/fluid_simulation.hpp"
#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

Body body_of(Vec3 half, float radius) {
  Body out{};
  out.half = half;
  out.radius = radius;
  out.turn = {0, 0, 0, 1};
  return out;
}
/// A ball of radius 0.3 m in the middle that moves and turns.
Body ball() {
  Body out = body_of({0, 0, 0}, 0.3f);
  out.velocity = {1, 0, 2};
  out.spin = {0, 3, -1};
  return out;
}

/// Particles of four sizes round the ball.
std::vector<Vec4> shell() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(-0.6f, 0.6f);
  std::vector<Vec4> out;
  while (out.size() < 200) {
    const Vec3 x{at(random), at(random), at(random)};
    if (dot(x, x) > 0.36f || dot(x, x) < 0.1f) continue;
    out.push_back(with_w(x, 0.2f * std::exp2(static_cast<float>(out.size() % 4) / 3)));
  }
  return out;
}
std::vector<Vec4> stirred(std::size_t count) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> any(-1, 1);
  std::vector<Vec4> v(count);
  for (Vec4& one : v) one = {any(random), any(random), any(random), 0};
  return v;
}

constexpr float nu = 2;
FluidState honey_round(const std::vector<Vec4>& points, const std::vector<Body>& bodies, double stick) {
  auto state = state_of(points, false);
  state.finest_support = 0.2f;
  auto& effects = state.parameters.effects;
  effects.values[index_of(EffectKind::Viscosity)] = nu;
  effects.options[static_cast<std::size_t>(EffectOption::ViscositySteps)] = 100;
  effects.options[static_cast<std::size_t>(EffectOption::ViscosityStick)] = stick;
  state.particles.all().velocity.from_host(stirred(points.size()));
  if (!bodies.empty()) state.obstacles.bodies.from_host(bodies);
  state.obstacles.sums.resize(2 * bodies.size());
  state.obstacles.sums.zero();
  return state;
}

/// Change of momentum, m_* m/s, and of angular momentum about the ball's middle, m_* m2/s, where m_* is the
/// mass of a particle of support 0.2 m; `all`: sum of the magnitudes of the particles' changes of momentum.
struct Exchange {
  Vec3 momentum, spin;
  float all;
};
Exchange exchange_of(const std::vector<Vec4>& points, const std::vector<Vec4>& before,
                     const std::vector<Vec4>& after) {
  Exchange out{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto units = static_cast<float>(mass(points[i]) / mass({0, 0, 0, 0.2f}));
    const Vec3 change = units * (xyz(after[i]) - xyz(before[i]));
    out.momentum += change;
    out.spin += cross(xyz(points[i]), change);
    out.all += length(change);
  }
  return out;
}

/// The body receives all momentum that the fluid loses, with any number of steps; coarse water that the
/// effect leaves out gives none.
SIM_TEST(Sticking, ABodyIsToldWhatTheFluidLoses) {
  NEEDS_EFFECTS;
  const auto points = shell();
  for (const double coarsest : {0.0, 1.0, 3.0}) {
    for (const double steps : {1.0, 3.0, 100.0}) {
      auto state = honey_round(points, {ball()}, 1);
      state.supports = level_supports(0.2);
      auto& options = state.parameters.effects.options;
      options[static_cast<std::size_t>(EffectOption::ViscosityCoarsest)] = coarsest;
      options[static_cast<std::size_t>(EffectOption::ViscositySteps)] = steps;
      const auto before = state.particles.all().velocity.to_host();
      const auto after = velocities_by(EffectKind::Viscosity, state);
      const Exchange change = exchange_of(points, before, after);
      if (coarsest == 3 && steps == 100) {
        ASSERT_GT(length(change.momentum), 50) << "for the test to mean anything";
        ASSERT_GT(length(change.spin), 5);
      }
      const auto sums = state.obstacles.sums.to_host();
      EXPECT_EQ(length(sums[0].push.value()), 0) << "the constraint's";
      const Vec3 told = (1 / state.parameters.dt) * sums[1].push.value();
      const Vec3 moment = (1 / state.parameters.dt) * sums[1].moment.value();
      EXPECT_LT(length(told - change.momentum), 2e-5f * change.all) << coarsest << ", " << steps;
      EXPECT_LT(length(moment - change.spin), 2e-5f * change.all) << coarsest << ", " << steps;
    }
  }
}

SIM_TEST(Sticking, WithoutViscosityItsRowsAreFreed) {
  NEEDS_EFFECTS;
  const auto points = shell();
  auto state = honey_round(points, {ball()}, 1);
  velocities_by(EffectKind::Viscosity, state);
  EXPECT_EQ(state.obstacles.rows.size(), 1u);
  exchange_effects(state, Scene{}, all_columns());
  EXPECT_EQ(state.obstacles.rows.size(), 1u) << "it is still on";
  state.parameters.effects = {};
  exchange_effects(state, Scene{}, all_columns());
  EXPECT_EQ(state.obstacles.rows.size(), 0u);
}

SIM_TEST(Sticking, WhatGoesWithABodyIsLeftAlone) {
  NEEDS_EFFECTS;
  const auto points = shell();
  auto state = honey_round(points, {ball()}, 1);
  std::vector<Vec4> v;
  for (const Vec4& p : points) v.push_back(with_w(ball().velocity_at(xyz(p)), 0));
  state.particles.all().velocity.from_host(v);
  const auto after = velocities_by(EffectKind::Viscosity, state);
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_LT(length(xyz(after[i]) - xyz(v[i])), 1e-4f) << i;
}

/// A column of a lattice in a shear flow over a box loses the momentum rho_0 nu times the shear per area d^2
/// and time, wherever its lowest particle lies.
SIM_TEST(Sticking, AnyLatticeFeelsTheStressOfTheShear) {
  NEEDS_EFFECTS;
  constexpr float shear = 3, viscosity = 1e-3f;  // low viscosity, so that the particles hardly slow down
  for (const float d : {0.05f, 0.1f}) {
    for (const float lowest : {0.11f, 0.5f, 0.99f}) {
      std::vector<Vec4> points, v;
      for (int k = 0; k < 4; ++k) {
        points.push_back({0, d * (lowest + static_cast<float>(k)), 0, 2 * d});
        v.push_back({shear * points.back().y, 0, 0, 0});
      }
      Body box = body_of({1, 0.5f, 1}, 0);
      box.centre = {0, -0.5f, 0};
      auto state = honey_round(points, {box}, 1);
      state.parameters.effects.values[index_of(EffectKind::Viscosity)] = viscosity;
      state.particles.all().velocity.from_host(v);
      velocities_by(EffectKind::Viscosity, state);
      const Vec3 told = state.obstacles.sums.to_host()[1].push.value();
      const float dt = state.parameters.dt;
      const float momentum = -told.x / dt * static_cast<float>(mass({0, 0, 0, state.finest_support}));
      EXPECT_NEAR(momentum / (d * d * dt) / (1000 * viscosity * shear), 1, 0.03)
          << d << ", lowest at " << lowest;
      EXPECT_NEAR(told.y, 0, 1e-9f);
    }
  }
}

SIM_TEST(Sticking, StickActsAlongTheSurfaceAlone) {
  NEEDS_EFFECTS;
  // A lone particle beside the ball: its speed along the surface falls from v to v / (1 + stick nu dt / (d s)
  // face), with spacing d = 0.2 m, distance s = 0.1 m and face = 0.5625. Along the normal the resistance is a
  // quarter of that at stick = 1, whatever the stick.
  constexpr float steps = nu * 1.0f / 180 / (0.2f * 0.1f) * 0.5625f;
  for (const float stick : {0.0f, 0.5f, 1.0f}) {
    auto state = honey_round({{0.4f, 0, 0, 0.4f}}, {body_of({0, 0, 0}, 0.3f)}, static_cast<double>(stick));
    state.particles.all().velocity.from_host({Vec4{2, 1, 0, 0}});
    const auto v = velocities_by(EffectKind::Viscosity, state);
    EXPECT_NEAR(v[0].x, 2 / (1 + steps / 4), 2e-4f) << stick;
    EXPECT_NEAR(v[0].y, 1 / (1 + stick * steps), 1e-4f) << stick;
  }
}

/// The ball as a free body of this mass, in masses of a particle of level 0.
FreeBody free_of(float units) {
  FreeBody out{};
  out.mass = units;
  out.volume = 10;
  out.inertia = (0.4f * 0.09f * units) * Vec3{1, 1, 1};
  return out;
}

/// However light the body and however few the steps: it receives the momentum that the fluid lost, up to
/// rounding, and gets no faster than the fluid.
SIM_TEST(Sticking, AFreeBodyAndTheFluidKeepTheirMomentumHoweverFewTheSteps) {
  NEEDS_EFFECTS;
  const auto points = shell();
  for (const float units : {0.2f, 3.0f, 1000.0f}) {
    for (const double steps : {1.0, 3.0, 100.0}) {
      auto state = honey_round(points, {ball()}, 1);
      state.parameters.effects.options[static_cast<std::size_t>(EffectOption::ViscositySteps)] = steps;
      state.obstacles.free.from_host({free_of(units)});
      const auto before = state.particles.all().velocity.to_host();
      const auto after = velocities_by(EffectKind::Viscosity, state);
      const Exchange change = exchange_of(points, before, after);
      const BodySum told = state.obstacles.sums.to_host()[1];
      const float dt = state.parameters.dt;
      EXPECT_LT(length((1 / dt) * told.push.value() - change.momentum), 2e-5f * change.all) << units;
      EXPECT_LT(length((1 / dt) * told.moment.value() - change.spin), 2e-5f * change.all) << units;
      if (steps < 100) continue;
      const Vec3 v = ball().velocity - (1 / (dt * units)) * told.push.value();
      if (units < 1) {
        EXPECT_LT(length(v), 1.2f) << "of a light ball at 2.2 m/s";
      } else if (units > 100) {
        EXPECT_LT(length(v - ball().velocity), 0.2f);
      }
    }
  }
}

/// One layer of thick honey at 1 m/s on a heavy box of 2 m x 1 m x 2 m. The sums over the particles at a body
/// must have room for thousands of viscous terms of 350 to 140,000 times a particle's mass each.
SIM_TEST(Sticking, AHeavyBodyUnderALayerOfThickHoneyComesToTheCommonSpeed) {
  NEEDS_EFFECTS;
  for (const auto& [d, viscosity] : {std::pair{0.02f, 5.0f}, {0.01f, 5.0f}, {0.01f, 500.0f}}) {
    constexpr int side = 60;
    std::vector<Vec4> points, v;
    for (int k = 0; k < side * side; ++k) {
      const auto i = static_cast<float>(k % side - side / 2), j = static_cast<float>(k / side - side / 2);
      points.push_back({d * (i + 0.5f), 0.2f * d, d * (j + 0.5f), 2 * d});
      v.push_back({1, 0, 0, 0});
    }
    Body box = body_of({1, 0.5f, 1}, 0);
    box.centre = {0, -0.5f, 0};
    auto state = honey_round(points, {box}, 1);
    state.finest_support = 2 * d;
    state.parameters.effects.values[index_of(EffectKind::Viscosity)] = viscosity;
    state.particles.all().velocity.from_host(v);
    FreeBody free{};
    free.mass = free.volume = 4 / (d * d * d);
    free.inertia = (free.mass / 3) * Vec3{1.25f, 2, 1.25f};
    state.obstacles.free.from_host({free});
    const auto after = velocities_by(EffectKind::Viscosity, state);
    const float units = side * side;
    const Vec3 told = state.obstacles.sums.to_host()[1].push.value();
    const float gained = -told.x / (state.parameters.dt * free.mass);
    EXPECT_NEAR(gained / (units / free.mass), 1, 0.05f) << d << ", " << viscosity;
    float kept = 0;
    for (const Vec4& one : after) kept += one.x / units;
    EXPECT_LT(kept, 0.05f) << d << ", " << viscosity;
    // 140,000 times the rounding of a float is 0.8 %.
    EXPECT_NEAR(gained * free.mass, (1 - kept) * units, 1e-2f * units) << d << ", " << viscosity;
  }
}

/// Adds adhesion with this work, and a tension.
void add_adhesion(FluidState& state, float tension, float work) {
  state.parameters.effects.values[index_of(EffectKind::Cohesion)] = tension;
  state.parameters.effects.values[index_of(EffectKind::Adhesion)] = work;
}

SIM_TEST(Sticking, AdhesionOfABoxIsThatOfAWall) {
  NEEDS_EFFECTS;
  for (const float s : {0.01f, 0.05f, 0.12f, 0.18f}) {
    Vec3 v[2];
    for (const bool wall : {false, true}) {
      auto state = state_of({{s, 0, 0, 0.2f}}, true);
      state.finest_support = 0.2f;
      if (wall) {
        state.walls.planes[state.walls.count++] = {{1, 0, 0}, 0};
      } else {
        Body box = body_of({1, 1, 1}, 0);
        box.centre = {-1, 0, 0};
        state.obstacles.bodies.from_host({box});
        state.obstacles.sums.resize(2);
        state.obstacles.sums.zero();
      }
      add_adhesion(state, 20, 50);
      state.particles.all().density.from_host({0.7f});
      state.particles.all().normal.from_host({Vec4{0.4f, 0.3f, 0, 0}});
      for (const Stage& stage : passes_of(EffectKind::Adhesion)) stage.run(state);
      v[wall] = xyz(state.particles.all().velocity.to_host()[0]);
      if (wall) continue;
      const BodySum told = state.obstacles.sums.to_host()[1];
      EXPECT_NEAR(told.push.value().x, state.parameters.dt * v[0].x, 1e-6f);
      EXPECT_NEAR(told.moment.value().z, 0, 1e-6f);
    }
    EXPECT_LT(v[1].x, 0);
    EXPECT_LT(length(v[0] - v[1]), 1e-5f * length(v[1])) << s;
  }
}

/// Removing water from a ball costs the work per area of the ball for particles of any size: the integral
/// over s of rho_0 a(s) ((R + s)^3 - R^3) / (3 R^2) ds. The adhesion pull does 0.75 of it.
SIM_TEST(Sticking, TakingWaterOffABallCostsTheWorkPerItsFace) {
  NEEDS_EFFECTS;
  constexpr float radius = 0.3f, tension = 20, work = 50;
  for (const float d : {0.05f, 0.1f}) {
    constexpr int steps = 400;
    const float h = 2 * d;
    std::vector<Vec4> points;
    for (int k = 0; k < steps; ++k)
      points.push_back({0, radius + h * (static_cast<float>(k) + 0.5f) / steps, 0, h});
    FluidState state;
    auto& p = state.particles;
    p.allocate(all_columns(), steps);
    p.all().position.from_host(points);
    p.all().velocity.zero();
    p.all().density.from_host(std::vector<float>(steps, 1));
    p.all().normal.zero();
    state.obstacles.bodies.from_host({body_of({0, 0, 0}, radius)});
    add_adhesion(state, tension, work);
    for (const Stage& stage : passes_of(EffectKind::Adhesion)) stage.run(state);
    const auto v = p.all().velocity.to_host();
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
      sum -= static_cast<double>(v[i].y / state.parameters.dt * h / steps *
                                 (points[i].y * points[i].y * points[i].y - radius * radius * radius) / 3);
    EXPECT_NEAR(1000 * sum / (0.09 * 0.75 * (work - tension)), 1, 0.02) << d;
  }
}

/// At a round surface the tension's part also acts across the normal, but turns no ball.
SIM_TEST(Sticking, AdhesionTurnsNoBall) {
  NEEDS_EFFECTS;
  auto state = state_of({{0.35f, 0, 0, 0.2f}}, true);
  state.finest_support = 0.2f;
  state.obstacles.bodies.from_host({body_of({0, 0, 0}, 0.3f)});
  state.obstacles.sums.resize(2);
  state.obstacles.sums.zero();
  add_adhesion(state, 20, 20);
  state.particles.all().density.from_host({0.7f});
  state.particles.all().normal.from_host({Vec4{0, 0.5f, 0, 0}});
  for (const Stage& stage : passes_of(EffectKind::Adhesion)) stage.run(state);
  const Vec3 v = xyz(state.particles.all().velocity.to_host()[0]);
  EXPECT_GT(v.y, 1e-3f) << "back into the water";
  const BodySum told = state.obstacles.sums.to_host()[1];
  EXPECT_LT(length(told.push.value() - state.parameters.dt * v), 1e-6f);
  EXPECT_EQ(length(told.moment.value()), 0);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
