/// Two particles that found no partner to merge with (stranded), and a coarser particle that helps: each
/// merges with a half of it.

#include <gmock/gmock.h>

#include "libsim/levels/split_merge.hpp"
#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// Two particles of level 0 beside one of level 1, which gives each of them a half of itself. Returns the
/// levels after the relays' pass; 9 marks a removed particle.
std::vector<int> levels_after(const Array<Body>& bodies) {
  const LevelSupports supports = level_supports(0.2);
  auto state = state_of(
      {{1 - 0.13f, 1, 1, supports.h[0]}, {1, 1, 1, supports.h[1]}, {1.13f, 1, 1, supports.h[0]}}, false);
  auto& p = state.particles.all();
  p.level.from_host({0, 1, 0});
  p.target.from_host({1, 1, 1});
  p.waiting.from_host({9, 0, 9});
  p.age.from_host({9, 9, 9});
  p.history.from_host({0x55, 0x55, 0x55});
  auto& l = state.levels;
  l.rules.inside_count = 0;
  l.wish.from_host({1, 0, 1});
  l.split_code.from_host({0, 0, 0});
  l.gone.from_host({0, 0, 0});
  l.first_bid().resize(3);
  l.second_bid().resize(3);
  l.counts.resize(1);
  l.counts.zero();
  const LevelFluid fluid{.particles = LevelView(state.particles),
                         .neighbours = state.particle_neighbours(),
                         .last_active = nullptr,
                         .solids = {state.walls, bodies.data(), static_cast<int>(bodies.size()), 0},
                         .supports = supports,
                         .rest_density = 1000,
                         .wall_gap = 0.1f};
  relay_stranded(l, fluid, state.particles.descents());
  const auto level = p.level.to_host();
  const auto gone = l.gone.to_host();
  std::vector<int> out;
  for (std::size_t i = 0; i < level.size(); ++i) out.push_back(gone[i] ? 9 : level[i]);
  return out;
}

SIM_TEST(Relay, SharesItselfAndNeverPutsAHalfIntoAnObstacle) {
  Array<Body> bodies;
  EXPECT_THAT(levels_after(bodies), testing::ElementsAre(1, 1, 9));
  for (const float side : {-1.0f, 1.0f}) {
    Body ball{};
    ball.radius = 0.03f;
    ball.turn = {0, 0, 0, 1};
    ball.centre = {1 + side * 0.065f, 1, 1};
    bodies.from_host({ball});
    EXPECT_THAT(levels_after(bodies), testing::ElementsAre(0, 1, 0));
    ball.centre.y = 1.05f;
    bodies.from_host({ball});
    EXPECT_THAT(levels_after(bodies), testing::ElementsAre(1, 1, 9)) << "beside it there is room";
  }
}

}  // namespace
}  // namespace sim::SIM_BACKEND
