/// The passes of vorticity confinement on lattices and small sets of particles.

#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// Turns confinement on, strong enough to show in one substep, for rotation at any rate.
void feed(FluidState& state, double from = 0, double most = 1e6) {
  auto& effects = state.parameters.effects;
  effects.values[index_of(EffectKind::Vorticity)] = 1;
  effects.options[static_cast<std::size_t>(EffectOption::VorticityFrom)] = from;
  effects.options[static_cast<std::size_t>(EffectOption::VorticityMost)] = most;
}

/// Velocities of a rotation about the vertical axis through `middle`.
std::vector<Vec4> turning(const std::vector<Vec4>& points, float rate, Vec3 middle) {
  std::vector<Vec4> v;
  for (const Vec4& p : points) v.push_back({rate * (p.z - middle.z), 0, -rate * (p.x - middle.x), 0});
  return v;
}
void give(FluidState& state, const std::vector<Vec4>& v) { state.particles.all().velocity.from_host(v); }
std::vector<Vec4> curls_of(FluidState& state) {
  passes_of(EffectKind::Vorticity).front().run(state);
  return state.particles.all().normal.to_host();
}

SIM_TEST(Vorticity, WhatTurnsAsAWholeHasItsCurlInsideAndNearlyAtFaces) {
  NEEDS_EFFECTS;
  constexpr int side = 9;
  const auto points = cube(side, 0.1f);
  for (const bool one_level : {true, false}) {
    auto state = state_of(points, one_level);
    feed(state);
    give(state, turning(points, 3, {0.2f, 0, 0.7f}));
    const auto curl = curls_of(state);
    const auto at = [&](int x, int y, int z) {
      return curl[static_cast<std::size_t>((z * side + y) * side + x)];
    };
    EXPECT_NEAR(at(4, 4, 4).y, 6, 0.01f);
    for (const Vec4& c : {at(4, 4, 4), at(0, 4, 4), at(4, 8, 4), at(4, 4, 0)}) {
      EXPECT_NEAR(c.y, 6, 0.9f) << "of a layer at a face";
      EXPECT_NEAR(c.w, c.y, 0.01f);
      EXPECT_LT(std::abs(c.x) + std::abs(c.z), 0.01f);
    }
  }
}

SIM_TEST(Vorticity, WhatTurnsAsAWholeIsNotPushed) {
  NEEDS_EFFECTS;
  constexpr int side = 9;
  const auto points = cube(side, 0.1f);
  auto state = state_of(points, true);
  feed(state);
  const auto before = turning(points, 3, {0.45f, 0, 0.45f});
  give(state, before);
  const auto v = velocities_by(EffectKind::Vorticity, state);
  const std::size_t middle = static_cast<std::size_t>((4 * side + 4) * side + 4);
  EXPECT_LT(length(xyz(v[middle]) - xyz(before[middle])), 0.02f * 6 * state.parameters.dt);
}

/// Among particles of mixed sizes too, the computed curl is that of the flow.
SIM_TEST(Vorticity, ACrowdOfMixedSizesHasTheCurlOfItsFlow) {
  NEEDS_EFFECTS;
  const auto points = mixed_ball();
  auto state = state_of(points, false);
  feed(state);
  give(state, turning(points, 3, {0, 0, 0}));
  const auto curl = curls_of(state);
  double sum = 0;
  int inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (length(xyz(points[i])) > 0.25f) continue;
    sum += static_cast<double>(curl[i].y);
    ++inside;
  }
  ASSERT_GT(inside, 10);
  EXPECT_NEAR(sum / inside, 6, 0.3);
}

/// A Lamb-Oseen vortex, largest curl 10 / s, core of 4 spacings, at two sizes. The acceleration round its
/// axis must be the effect's coefficient times the curl.
SIM_TEST(Vorticity, AVortexIsTurnedOnByItsOwnCurl) {
  NEEDS_EFFECTS;
  for (const float d : {0.05f, 0.1f}) {
    const float core2 = 16 * d * d;
    std::vector<Vec4> points, v;
    for (int i = 0; i < 21 * 21 * 7; ++i) {
      const Vec3 x{d * (static_cast<float>(i % 21) - 10.3f), d * static_cast<float>(i / 441),
                   d * (static_cast<float>(i / 21 % 21) - 10.3f)};
      const float r2 = x.x * x.x + x.z * x.z;
      const float turn = 5 * core2 / r2 * (1 - std::exp(-r2 / core2));
      points.push_back(with_w(x, 2 * d));
      v.push_back({turn * x.z, 0, -turn * x.x, 0});
    }
    auto state = state_of(points, true);
    feed(state);
    give(state, v);
    const auto after = velocities_by(EffectKind::Vorticity, state);
    double along = 0, norm = 0, across = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec4 p = points[i];
      const float r = std::hypot(p.x, p.z);
      if (r > 6 * d || std::abs(p.y - 3 * d) > 0.5f * d) continue;
      const double omega = 10 * std::exp(static_cast<double>(-r * r / core2));
      const Vec3 gain = (1 / state.parameters.dt) * (xyz(after[i]) - xyz(v[i]));
      along += omega * static_cast<double>((gain.x * p.z - gain.z * p.x) / r);
      across += omega * static_cast<double>((gain.x * p.x + gain.z * p.z) / r);
      norm += omega * omega;
    }
    EXPECT_NEAR(along / norm, 1, 0.1) << d;
    EXPECT_NEAR(across / norm, 0, 0.02) << d;
  }
}

/// A Lamb-Oseen vortex with random velocities added: the slopes of the curl must follow its mean, not the
/// noise.
SIM_TEST(Vorticity, AVortexInUnrestIsTurnedOnByItsOwnCurl) {
  NEEDS_EFFECTS;
  constexpr float d = 0.05f, core2 = 16 * d * d;
  std::mt19937 random(3);
  std::normal_distribution<float> jitter(0, 0.15f);
  std::vector<Vec4> points, v;
  for (int i = 0; i < 21 * 21 * 7; ++i) {
    const Vec3 x{d * (static_cast<float>(i % 21) - 10.3f), d * static_cast<float>(i / 441),
                 d * (static_cast<float>(i / 21 % 21) - 10.3f)};
    const float r2 = x.x * x.x + x.z * x.z;
    const float turn = 5 * core2 / r2 * (1 - std::exp(-r2 / core2));
    points.push_back(with_w(x, 2 * d));
    v.push_back({turn * x.z + jitter(random), jitter(random), -turn * x.x + jitter(random), 0});
  }
  auto state = state_of(points, true);
  feed(state);
  give(state, v);
  const auto after = velocities_by(EffectKind::Vorticity, state);
  double along = 0, norm = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec4 p = points[i];
    const float r = std::hypot(p.x, p.z);
    if (r > 6 * d || std::abs(p.y - 3 * d) > 0.5f * d) continue;
    const double omega = 10 * std::exp(static_cast<double>(-r * r / core2));
    const Vec3 gain = (1 / state.parameters.dt) * (xyz(after[i]) - xyz(v[i]));
    along += omega * static_cast<double>((gain.x * p.z - gain.z * p.x) / r);
    norm += omega * omega;
  }
  EXPECT_NEAR(along / norm, 1, 0.1);
}

SIM_TEST(Vorticity, WhatTurnsTooSlowlyOrTooFastIsLeftAsItIs) {
  NEEDS_EFFECTS;
  const auto points = mixed_ball();
  const auto changed = [&](double from, double most) {
    auto state = state_of(points, false);
    feed(state, from, most);
    const auto before = turning(points, 3, {0.1f, 0, 0});
    give(state, before);
    const auto after = velocities_by(EffectKind::Vorticity, state);
    int out = 0;
    for (std::size_t i = 0; i < points.size(); ++i) out += length(xyz(after[i]) - xyz(before[i])) > 0;
    return out;
  };
  EXPECT_GT(changed(0, 1e6), 100);
  EXPECT_GT(changed(1, 100), 100);
  EXPECT_EQ(changed(100, 1e6), 0);
  EXPECT_EQ(changed(0, 0.001), 0);
}

/// The swirl that saliency reads: the mean curl of the last substep; particles too coarse for the effect get
/// 0.
SIM_TEST(Vorticity, ItsSwirlIsShownToSaliency) {
  NEEDS_EFFECTS;
  constexpr int side = 9;
  const auto points = cube(side, 0.1f);
  auto state = state_of(points, false);
  feed(state);
  give(state, turning(points, 3, {0.45f, 0, 0.45f}));
  std::vector<std::uint8_t> level(points.size(), 0);
  std::vector<float> before(points.size(), 2);
  const std::size_t middle = static_cast<std::size_t>((4 * side + 4) * side + 4);
  level.back() = 3;
  auto& p = state.particles.all();
  p.level.from_host(level);
  p.swirl.from_host(before);
  state.parameters.effects.options[static_cast<std::size_t>(EffectOption::VorticityCoarsest)] = 2;
  state.supports = level_supports(0.2);
  state.parameters.substeps = 2;
  state.substep = 0;
  velocities_by(EffectKind::Vorticity, state);
  EXPECT_EQ(p.swirl.to_host(), before);
  state.substep = 1;
  give(state, turning(points, 3, {0.45f, 0, 0.45f}));
  for (const Stage& stage : passes_of(EffectKind::Vorticity)) stage.run(state);
  const auto swirl = p.swirl.to_host();
  EXPECT_NEAR(swirl[middle], 6, 0.1f);
  EXPECT_EQ(swirl.back(), 0);
}

SIM_TEST(Vorticity, WaterAtRestAndLoneDropsStayAsTheyAre) {
  NEEDS_EFFECTS;
  auto points = cube(5, 0.1f);
  points.push_back({9, 0, 0, 0.2f});
  auto state = state_of(points, true);
  feed(state);
  const std::vector<Vec4> before(points.size(), Vec4{1, 2, 3, 0});
  give(state, before);
  const auto v = velocities_by(EffectKind::Vorticity, state);
  for (const Vec4& one : v) EXPECT_EQ(length(xyz(one) - Vec3{1, 2, 3}), 0);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
