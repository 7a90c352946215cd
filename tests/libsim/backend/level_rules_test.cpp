/// Rules of splitting and merging one by one: the dead band of targets.

#include <algorithm>
#include <cmath>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// Targets after grading of particles without neighbours, all of level 1, with N = 4.
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
  // N (1 - s): 0.4, 1.0, 1.9, 2.1, 2.2, 2.3, 2.9, 3.1, 4.
  const std::vector<float> s{0.9f, 0.75f, 0.525f, 0.475f, 0.45f, 0.425f, 0.275f, 0.225f, 0};
  EXPECT_EQ(graded(s, 0), (std::vector<std::uint8_t>{0, 1, 1, 2, 2, 2, 2, 3, 3}));
  EXPECT_EQ(graded(s, 0.25f), (std::vector<std::uint8_t>{0, 1, 1, 1, 1, 2, 2, 3, 3}));
}

}  // namespace
}  // namespace sim::SIM_BACKEND
