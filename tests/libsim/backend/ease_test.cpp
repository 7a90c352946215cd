/// The easing of the density constraint near particles that just split or merged, against brute force.

#include <random>

#include "libsim/levels/easing.hpp"
#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr float h = 0.3f;

/// Mixed levels in a box; one in forty is new; if `resting`, one in three is not solved.
FluidState crowd(int n, bool resting) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.one_level = false;
  state.finest_support = state.lightest_support = h;
  state.supports = level_supports(static_cast<double>(h));
  state.all_active = !resting;
  auto& p = state.particles;
  p.allocate(all_columns(), n);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> at(0, 1.5f);
  std::vector<Vec4> position;
  std::vector<int> id;
  std::vector<std::uint8_t> level, age, active;
  for (int i = 0; i < n; ++i) {
    level.push_back(static_cast<std::uint8_t>(i % 4));
    position.push_back({at(random), at(random), at(random), state.supports.h[i % 4]});
    id.push_back(i);
    age.push_back(i % 40 == 0 ? static_cast<std::uint8_t>(i / 40 % 5) : std::uint8_t{255});
    active.push_back(!resting || i % 3 != 0);
  }
  p.all().position.from_host(position);
  p.all().predicted.from_host(position);
  p.all().predicted_next.from_host(position);
  p.all().velocity.zero();
  p.all().id.from_host(id);
  p.all().level.from_host(level);
  p.all().age.from_host(age);
  p.all().active.from_host(active);
  p.all().ease.from_host(std::vector<float>(static_cast<std::size_t>(n), -1));
  p.all().lambda.zero();
  p.all().density.from_host(std::vector<float>(static_cast<std::size_t>(n), 1));
  p.all().saliency.zero();
  return state;
}

void equals_brute_force(bool resting) {
  auto state = crowd(1500, resting);
  do {
    neighbours_stage().run(state);
  } while (state.neighbours.grow());
  ease_stage().run(state);
  const auto& p = state.particles;
  const auto x = p.all().predicted.to_host();
  const auto age = p.all().age.to_host();
  const auto active = p.all().active.to_host();
  const auto ease = p.all().ease.to_host();
  int eased = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    int youngest = age[i];
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Vec3 offset = xyz(x[i]) - xyz(x[j]);
      const float reach = 0.5f * (x[i].w + x[j].w);
      if (i != j && dot(offset, offset) < reach * reach) youngest = std::min<int>(youngest, age[j]);
    }
    const bool near_fresh = active[i] && youngest < LevelRules::ease_frames;
    ASSERT_EQ(ease[i], near_fresh ? state.levels.rules.ease[youngest] : 1.0f) << i;
    eased += near_fresh;
  }
  EXPECT_GT(eased, 100);
  EXPECT_LT(eased, 1400);
}

SIM_TEST(Ease, FollowsTheYoungestWithinTheSupport) { equals_brute_force(false); }
SIM_TEST(Ease, LeavesOutWhoIsNotSolved) { equals_brute_force(true); }

/// A density 2 % above rest comes from overlapping particles, which the easing separates slowly. At 10 %
/// above rest particles are in an impact, and the constraint applies in full.
SIM_TEST(Ease, WhatIsPressedHasTheWholeConstraint) {
  const float ease[] = {0.1f, 0.1f, 0.1f, 0.1f, 0.7f, 1};
  const float density[] = {0.9f, 1.02f, 1.06f, 1.3f, 1.06f, 1.01f};
  const float wanted[] = {0.1f, 0.1f, 0.5f, 1, 0.7f, 1};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(Easing::share(ease[i], density[i]), wanted[i], 1e-5f) << i;
}

SIM_TEST(Ease, WeakensTheMultipliersOfTheProjections) {
  auto state = crowd(300, false);
  do {
    neighbours_stage().run(state);
  } while (state.neighbours.grow());
  constrain_density(state, DensityView(state.particles));
  auto& p = state.particles.all();
  const auto whole = p.lambda.to_host();
  std::vector<float> ease;
  for (std::size_t i = 0; i < whole.size(); ++i) ease.push_back(i % 2 ? 1 : 0.3f);
  p.ease.from_host(ease);
  density_stage().run(state);
  const auto density = p.density.to_host();
  const auto eased = p.lambda.to_host();
  int weaker = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ASSERT_FLOAT_EQ(eased[i], whole[i] * Easing::share(ease[i], density[i])) << i;
    weaker += eased[i] > whole[i];
  }
  EXPECT_GT(weaker, 5);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
