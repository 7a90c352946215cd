#include "libsim/particles/walls.hpp"

#include <vector>

#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

Walls corner() {
  Walls out{};
  out.planes[out.count++] = {{1, 0, 0}, 0};
  out.planes[out.count++] = {{0, 1, 0}, 0};
  return out;
}

SIM_TEST(Walls, WhatMovesAtOneSpeedKeepsItsOrder) {
  // Ten layers a spacing apart move by four spacings towards the wall.
  const Walls walls = corner();
  std::vector<float> place;
  for (int layer = 0; layer < 10; ++layer) {
    Vec3 x{0.1f * (static_cast<float>(layer) + 0.5f), 1, 0};
    const Vec3 to = x + Vec3{-0.4f, 0, 0.2f};
    const bool held = walls.hold_back(x, to, 0.01f);
    EXPECT_EQ(held, layer < 5) << layer;
    EXPECT_FLOAT_EQ(x.y, 1);
    EXPECT_FLOAT_EQ(x.z, 0.2f) << "along the wall nothing holds";
    place.push_back(x.x);
  }
  EXPECT_GE(place[0], 0.01f);
  for (std::size_t i = 1; i < place.size(); ++i) EXPECT_GT(place[i] - place[i - 1], 0.02f) << i;
}

SIM_TEST(Walls, HoldBackTouchesNothingFarFromWalls) {
  const Walls walls = corner();
  Vec3 x{5, 5, 5};
  EXPECT_FALSE(walls.hold_back(x, {4, 3, 5}, 0.01f));
  EXPECT_EQ(x.x, 4);
  EXPECT_EQ(x.y, 3);
  // A particle on the border stays; one behind it comes back.
  Vec3 resting{0.01f, 2, 0};
  EXPECT_TRUE(walls.hold_back(resting, {0, 2, 0}, 0.01f));
  EXPECT_NEAR(resting.x, 0.01f, 1e-6f);
  Vec3 lost{-3, 2, 0};
  EXPECT_TRUE(walls.hold_back(lost, {-4, 2, 0}, 0.01f));
  EXPECT_NEAR(lost.x, 0.01f, 1e-6f);
}

/// The corner with a hole in its vertical wall: y from 1 to 2.
Walls corner_with_hole() {
  Walls out = corner();
  out.openings[out.opening_count++] = {0, {-9, 1, -9}, {9, 2, 9}};
  return out;
}

SIM_TEST(Walls, LetThroughWhatMeetsThePlaneBeforeAnOpening) {
  const Walls walls = corner_with_hole();
  Vec3 level{0.5f, 1.5f, 0};
  EXPECT_FALSE(walls.hold_back(level, {-3, 1.5f, 0}, 0.01f));
  EXPECT_EQ(level.x, -3);
  EXPECT_TRUE(walls.through(level));
  // `rising` passes the wall through the hole and ends higher than the hole; `late` meets the wall below the
  // hole, although its path ends at the height of the hole.
  Vec3 rising{0.5f, 1.5f, 0};
  EXPECT_FALSE(walls.hold_back(rising, {-3, 4, 0}, 0.01f));
  EXPECT_EQ(rising.y, 4);
  Vec3 late{0.5f, 0.5f, 0};
  EXPECT_TRUE(walls.hold_back(late, {-0.5f, 1.4f, 0}, 0.01f));
  EXPECT_FALSE(walls.through(late));
  // Behind the plane of the hole a particle is held by the other walls only.
  Vec3 after{-1, 0.5f, 0};
  EXPECT_FALSE(walls.hold_back(after, {-2, 0.3f, 0}, 0.01f));
  EXPECT_TRUE(walls.hold_back(after, {-2, -0.3f, 0}, 0.01f));
  EXPECT_GT(after.y, 0);
  EXPECT_LT(after.x, 0);
}

SIM_TEST(Walls, NeitherPushNorCountBeforeAnOpening) {
  const Walls walls = corner_with_hole();
  const float h = 0.3f;
  Vec3 gradient;
  EXPECT_EQ(walls.missing({0.01f, 1.5f, 0}, h, gradient), 0);
  EXPECT_EQ(length(gradient), 0);
  EXPECT_EQ(walls.missing({-0.1f, 0.8f, 0}, h, gradient), 0) << "through the plane";
  EXPECT_GT(walls.missing({0.01f, 0.8f, 0}, h, gradient), 0.4f);
  EXPECT_GT(gradient.x * -1, 0);
  Vec3 x{0.001f, 1.5f, 0};
  EXPECT_FALSE(walls.project(x, {0.05f, 1.5f, 0}, 0.01f));
  EXPECT_TRUE(walls.holds({-0.1f, 1.5f, 0}, 0.01f));
  EXPECT_FALSE(walls.holds({-0.1f, 0.5f, 0}, 0.01f));
  Vec3 beside{-0.001f, 0.9f, 0};
  EXPECT_TRUE(walls.project(beside, {0.05f, 0.9f, 0}, 0.01f));
  EXPECT_NEAR(beside.x, 0.01f, 1e-6f);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
