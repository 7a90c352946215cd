/// Rules of splitting and merging one by one: the dead band and the grading of targets.

#include <algorithm>
#include <cmath>
#include <random>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// Target levels of particles of level 1 after the pass that applies `dead_band`: they get a target coarser
/// than 1 only if N (1 - s) is at least 2 + dead_band. There are N = 4 levels; s is the saliency.
std::vector<std::uint8_t> graded(const std::vector<float>& saliency, float dead_band) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.levels.rules.dead_band = dead_band;
  state.levels.rules.graded = false;
  auto& p = state.particles;
  const auto n = saliency.size();
  p.allocate(all_columns(), static_cast<int>(n));
  std::vector<std::uint8_t> target;
  for (const float s : saliency) {
    const int level = static_cast<int>(std::floor(4 * (1 - s)));
    target.push_back(static_cast<std::uint8_t>(std::min(level, 3)));
  }
  p.all().level.from_host(std::vector<std::uint8_t>(n, 1));
  p.all().saliency.from_host(saliency);
  p.all().target.from_host(target);
  graded_targets_stage().run(state);
  return p.all().target.to_host();
}

SIM_TEST(LevelRules, TheDeadBandHoldsBackOnlyTheWayToCoarser) {
  // With N = 4 levels, N (1 - s) is 0.4, 1.0, 1.9, 2.1, 2.2, 2.3, 2.9, 3.1, 4.
  const std::vector<float> s{0.9f, 0.75f, 0.525f, 0.475f, 0.45f, 0.425f, 0.275f, 0.225f, 0};
  EXPECT_EQ(graded(s, 0), (std::vector<std::uint8_t>{0, 1, 1, 2, 2, 2, 2, 3, 3}));
  EXPECT_EQ(graded(s, 0.25f), (std::vector<std::uint8_t>{0, 1, 1, 1, 1, 2, 2, 3, 3}));
}

bool are_neighbours(const Vec4& a, const Vec4& b) {
  const Vec3 offset = xyz(a) - xyz(b);
  const float h = 0.5f * (a.w + b.w);
  return dot(offset, offset) < h * h;
}

SIM_TEST(LevelRules, GradingTakesTwoSweepsUntilNoTargetChanges) {
  constexpr std::size_t n = 400;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(0, 1);
  std::vector<Vec4> points;
  std::vector<std::uint8_t> expected;
  std::vector<std::vector<int>> lists(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto level = static_cast<float>(i % 4);
    points.push_back({at(random), at(random), at(random), 0.1f * std::exp2(level / 3)});
    expected.push_back(static_cast<std::uint8_t>(i % 20 < 3 ? i % 20 : 3));  // mostly the coarsest
    for (std::size_t j = 0; j < n; ++j)
      if (j != i) lists[i].push_back(static_cast<int>(j));
  }
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.levels.rules.dead_band = 0;
  state.levels.rules.graded = true;
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(n));
  state.neighbours.assign(lists);
  p.all().position.from_host(points);
  p.all().target.from_host(expected);
  profile_launches(true);
  graded_targets_stage().run(state);
  const auto launches = launch_times();
  profile_launches(false);

  const auto before = expected;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (expected[i] < expected[j] + 2 || !are_neighbours(points[i], points[j])) continue;
        expected[i] = static_cast<std::uint8_t>(expected[j] + 1);
        changed = true;
      }
    }
  }
  const auto changed_to = [&](int level) {
    int count = 0;
    for (std::size_t i = 0; i < n; ++i) count += before[i] == 3 && expected[i] == level;
    return count;
  };
  EXPECT_GT(changed_to(1), 5);
  EXPECT_GT(changed_to(2), 5);
  EXPECT_EQ(p.all().target.to_host(), expected);
  const auto sweeps = std::find_if(launches.begin(), launches.end(),
                                   [](const auto& launch) { return launch.label == "grade targets"; });
  ASSERT_NE(sweeps, launches.end());
  EXPECT_EQ(sweeps->launches, 2);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
