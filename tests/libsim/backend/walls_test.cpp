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
  // What lies on the border stays there, what was put behind it comes back.
  Vec3 resting{0.01f, 2, 0};
  EXPECT_TRUE(walls.hold_back(resting, {0, 2, 0}, 0.01f));
  EXPECT_NEAR(resting.x, 0.01f, 1e-6f);
  Vec3 lost{-3, 2, 0};
  EXPECT_TRUE(walls.hold_back(lost, {-4, 2, 0}, 0.01f));
  EXPECT_NEAR(lost.x, 0.01f, 1e-6f);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
