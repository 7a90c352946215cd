/// The passes of the effect viscosity on small sets of particles.

#include <array>
#include <cstring>

#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// A loose ball of particles of four sizes with random velocities.
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
/// Momentum, angular momentum, and the sum of the particles' magnitudes.
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

/// Positions after the effect's passes, of which the last shifts particles at random by a small share of a
/// spacing.
std::vector<Vec4> loosened(FluidState& state, float gravity) {
  state.parameters.gravity = gravity;
  state.parameters.effects.values[index_of(EffectKind::Viscosity)] = 1;
  velocities_by(EffectKind::Viscosity, state);
  return state.particles.all().position.to_host();
}

SIM_TEST(Viscosity, LoosensWhatIsInsideUnderGravityByAShareOfASpacing) {
  NEEDS_EFFECTS;
  for (const float d : {0.05f, 0.15f}) {
    const auto points = cube(9, d);
    auto early = state_of(points, true), state = state_of(points, true);
    EXPECT_EQ(length(xyz(loosened(early, 9.81f)[364]) - xyz(points[364])), 0) << "not the last substep";
    state.substep = state.parameters.substeps - 1;
    const auto after = loosened(state, 9.81f);
    const auto density = state.particles.all().density.to_host();
    const float most = 0.04f * d;
    Vec3 sum{0, 0, 0};
    float squares = 0;
    float inside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 step = xyz(after[i]) - xyz(points[i]);
      EXPECT_EQ(after[i].w, points[i].w);
      if (density[i] < 0.95f) {
        EXPECT_EQ(length(step), 0) << "the surface keeps still";
        continue;
      }
      ++inside;
      for (const float one : {step.x, step.y, step.z}) EXPECT_LE(std::abs(one), 1.001f * most);
      sum += step;
      squares += dot(step, step);
    }
    ASSERT_GE(inside, 343);
    // Shifts are uniform within +- `most` along each axis, so that the mean square of each component is a
    // third of most^2. There is no common shift.
    EXPECT_NEAR(squares / inside, most * most, 0.15f * most * most);
    EXPECT_LT(length(sum) / inside, 0.15f * most);
  }
}

SIM_TEST(Viscosity, LoosensNothingWithoutGravityOrWhereSizesMix) {
  NEEDS_EFFECTS;
  const auto points = cube(7, 0.05f);
  for (const bool one_level : {true, false}) {
    auto state = state_of(points, one_level);
    state.substep = state.parameters.substeps - 1;
    const auto after = loosened(state, one_level ? 0 : 9.81f);
    EXPECT_EQ(std::memcmp(after.data(), points.data(), points.size() * sizeof(Vec4)), 0) << one_level;
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

/// Computes the new velocities again from the equation in double, beside a wall.
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
        const double turn = 1 - 2 * stick, upright = 0.25 + 0.75 * turn;
        pull(points[j], {-1 - y[0], y[1], y[2]}, {-upright * u[0], turn * u[1], turn * u[2]});
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

}  // namespace
}  // namespace sim::SIM_BACKEND
