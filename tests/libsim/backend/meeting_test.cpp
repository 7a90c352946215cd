/// Contacts between bodies, without water: impulses, friction, and rest on each other.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libsim/backend/backend_test.hpp"
#include "tests/libsim/backend/bodies_apart.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float g = 9.81f;

SIM_TEST(Meeting, BallsHeadOnGoOnTogether) {
  BodiesApart two;
  two.add(BodiesApart::sphere({0, 0, 0}, 0.2f), 1);
  two.add(BodiesApart::sphere({1, 0, 0}, 0.2f), 1);
  two.push(0, {3, 0, 0});
  two.step(30);
  EXPECT_EQ(two.velocity(1).x, 0) << "they are still apart";
  two.step(30);
  EXPECT_NEAR(two.velocity(0).x, 1.5f, 1e-5f);
  EXPECT_NEAR(two.velocity(1).x, 1.5f, 1e-5f);
  EXPECT_NEAR(two.energy(), 0.5f * 4.5f, 1e-4f) << "of 4.5 J that relative to their middle is lost";
  EXPECT_NEAR(two.gap_of_balls(0, 1), 0, 1e-5f);
}

SIM_TEST(Meeting, BallsThatGrazeShareWhatLiesAlongTheirCentres) {
  for (const float ratio : {1.0f, 3.0f}) {
    BodiesApart two;
    two.dt = 1.0f / 2000;
    two.add(BodiesApart::sphere({0, 0, 0}, 0.2f), 1);
    two.add(BodiesApart::sphere({1, 0.2f, 0}, 0.2f), ratio);
    two.push(0, {3, 0, 0});
    const Vec3 turning = two.angular_momentum();
    two.step(1000);
    // They hit at 30 degrees; the impulse makes their speeds along the normal equal.
    const Vec3 n{std::sqrt(0.75f), 0.5f, 0};
    const float along = 3 * n.x;
    const float kept = along / (1 + ratio);
    EXPECT_NEAR(dot(two.velocity(0), n), kept, 0.02f);
    EXPECT_NEAR(dot(two.velocity(1), n), kept, 0.02f);
    EXPECT_NEAR(length(two.velocity(1) - kept * n), 0, 0.03f) << "balls are smooth";
    EXPECT_NEAR(two.energy(), 4.5f - 0.5f * along * along * ratio / (1 + ratio), 0.02f);
    EXPECT_LT(length(two.momentum() - Vec3{3, 0, 0}), 1e-5f);
    EXPECT_LT(length(two.angular_momentum() - turning), 1e-4f);
    EXPECT_LT(length(two.by_others[0] + two.by_others[1]), 1e-6f);
    EXPECT_EQ(length(two.spin(1)), 0) << "nor does a rounding turn them";
  }
}

SIM_TEST(Meeting, ABoxRestsOnAFixedBox) {
  for (const float tilt : {0.0f, 0.2f}) {
    BodiesApart two;
    two.gravity = g;
    two.add(BodiesApart::box({0, 0.5f, 0}, {1, 0.2f, 1}), 0);
    Body brick = BodiesApart::box({0.1f, 0.8f, 0.05f}, {0.3f, 0.2f, 0.4f});
    brick.turn = turned_by(brick.turn, {tilt, 0, tilt});
    two.add(brick, 1);
    float energy = two.energy();
    for (int step = 0; step < 360; ++step) {
      two.step();
      EXPECT_LT(two.energy(), energy + 2e-3f) << step;
      energy = two.energy();
      if (step == 180) brick = two.bodies[1];
    }
    const Body& at = two.bodies[1];
    EXPECT_NEAR(at.centre.y, 0.7f, 2e-4f);
    EXPECT_LT(length(two.velocity(1)), tilt > 0 ? 0.2f : 1e-3f) << "a smooth box may slide";
    EXPECT_NEAR(turned(at.turn, {0, 1, 0}).y, 1, 1e-5f);
    if (tilt > 0) continue;
    EXPECT_LT(length(at.centre - brick.centre), 1e-4f);
    EXPECT_NEAR(two.by_others[1].y, g * two.dt, 1e-4f);
    EXPECT_NEAR(two.by_others[0].y, -g * two.dt, 1e-4f);
  }
}

SIM_TEST(Meeting, AHeavyBoxRestsOnALightOne) {
  for (const float ratio : {1.0f, 400.0f}) {
    BodiesApart two;
    two.gravity = g;
    two.add_floor();
    two.add(BodiesApart::box({0, 0.1f, 0}, {0.4f, 0.2f, 0.4f}), 1);
    two.add(BodiesApart::box({0.01f, 0.3f, 0.02f}, {0.3f, 0.2f, 0.3f}), ratio);
    two.step(360);
    EXPECT_NEAR(two.bodies[0].centre.y, 0.1f, 2e-4f) << ratio;
    EXPECT_NEAR(two.bodies[1].centre.y, 0.3f, 2e-4f) << ratio;
    EXPECT_NEAR(two.frees[0].by_walls.y, (1 + ratio) * g * two.dt, 2e-3f * (1 + ratio) * g * two.dt);
  }
}

/// A force as of water between the two boxes pushes the lower box down; the floor stops it.
SIM_TEST(Meeting, ABoxThatIsPushedDownStillBearsAnother) {
  BodiesApart two;
  two.gravity = g;
  two.add_floor();
  two.add(BodiesApart::box({0, 0.1f, 0}, {0.4f, 0.2f, 0.4f}), 1);
  two.add(BodiesApart::box({0.01f, 0.3f, 0.02f}, {0.3f, 0.2f, 0.3f}), 100);
  for (int step = 0; step < 180; ++step) {
    two.frees[0].force = {0, -1000, 0};
    two.step();
  }
  EXPECT_NEAR(two.bodies[1].centre.y, 0.3f, 2e-4f);
}

SIM_TEST(Meeting, ATowerStands) {
  BodiesApart tower;
  tower.gravity = g;
  tower.add_floor();
  constexpr int boxes = 8;
  for (int k = 0; k < boxes; ++k)
    tower.add(BodiesApart::box({0, 0.1f + 0.2f * static_cast<float>(k), 0}, {0.4f, 0.2f, 0.4f}), 1, 0.3f);
  const float energy = tower.energy();
  tower.step(900);
  EXPECT_LT(tower.energy(), energy * 1.0001f);
  for (int k = 0; k < boxes; ++k) {
    const Vec3 at = tower.bodies[static_cast<std::size_t>(k)].centre;
    EXPECT_NEAR(at.y, 0.1f + 0.2f * static_cast<float>(k), 5e-4f);
    EXPECT_LT(std::hypot(at.x, at.z), 2e-3f);
  }
}

SIM_TEST(Meeting, FrictionBrakesABoxByMuG) {
  for (const float mu : {0.1f, 0.4f}) {
    BodiesApart one;
    one.gravity = g;
    one.add_floor();
    one.add(BodiesApart::box({0, 0.1f, 0}, {0.4f, 0.2f, 0.4f}), 2, mu);
    one.push(0, {2, 0, 1});
    const float began = std::sqrt(5.0f);
    one.step(60);
    EXPECT_NEAR(length(one.velocity(0)), began - mu * g / 3, 0.01f) << mu;
    EXPECT_NEAR(one.velocity(0).x / one.velocity(0).z, 2, 0.01f) << "it brakes along the way";
    one.step(400);
    EXPECT_LT(length(one.velocity(0)), 1e-4f);
    EXPECT_NEAR(length(one.bodies[0].centre - Vec3{0, 0.1f, 0}), began * began / (2 * mu * g), 0.03f);
  }
}

SIM_TEST(Meeting, FrictionMakesABallRoll) {
  BodiesApart one;
  one.gravity = g;
  one.add_floor();
  one.add(BodiesApart::sphere({0, 0.2f, 0}, 0.2f), 1, 0.3f);
  one.push(0, {2, 0, 0});
  // It slides for 2 v / (7 mu g) = 0.19 s.
  one.step(20);
  EXPECT_GT(one.velocity(0).x, 1.6f);
  one.step(100);
  EXPECT_NEAR(one.velocity(0).x, 10.0f / 7, 2e-3f);
  EXPECT_NEAR(one.spin(0).z, -10.0f / 7 / 0.2f, 0.01f);
}

SIM_TEST(Meeting, FrictionHoldsABoxOnARampUpToItsAngle) {
  const float slope = 0.4f;
  for (const float mu : {0.5f, 0.25f}) {
    BodiesApart two;
    two.gravity = g;
    Body ramp = BodiesApart::box({0, 1, 0}, {3, 0.2f, 1});
    ramp.turn = turned_by(ramp.turn, {0, 0, slope});
    Body brick = BodiesApart::box(ramp.centre + turned(ramp.turn, {0, 0.2f, 0}), {0.3f, 0.2f, 0.3f});
    brick.turn = ramp.turn;
    two.add(ramp, 0, 1);
    two.add(brick, 1, mu * mu);  // the pair uses the geometric mean
    two.step(90);
    const float slides = std::sin(slope) - mu * std::cos(slope);
    EXPECT_NEAR(length(two.velocity(1)), slides > 0 ? 0.5f * g * slides : 0.0f, 5e-3f) << mu;
    if (slides < 0) {
      EXPECT_LT(length(two.bodies[1].centre - brick.centre), 1e-4f);
    }
  }
}

/// No corner is near the other body.
SIM_TEST(Meeting, EdgesMeetEdges) {
  const float quarter = 1.57079633f;
  for (const bool capsules : {true, false}) {
    const auto rod = [&](Vec3 at, float length) {
      return capsules ? BodiesApart::capsule(at, 0.1f, length) : BodiesApart::box(at, {0.2f, length, 0.2f});
    };
    BodiesApart two;
    Body lower = rod({0, 0, 0}, 1);
    lower.turn = turned_by(lower.turn, {0, 0, quarter});
    Body upper = rod({0.13f, 0.6f, 0.02f}, 1);
    upper.turn = turned_by(upper.turn, {quarter, 0, 0});
    if (!capsules) {
      // Turned so that edges meet.
      lower.turn = turned_by(lower.turn, {quarter / 2, 0, 0});
      upper.turn = turned_by(upper.turn, {0, 0, quarter / 2});
    }
    two.add(lower, 0);
    two.add(upper, 1);
    two.push(1, {0, -2, 0});
    two.step(60);
    EXPECT_NEAR(two.velocity(1).y, 0, 0.05f) << capsules;
    EXPECT_NEAR(two.bodies[1].centre.y, capsules ? 0.2f : 0.2f * std::sqrt(2.0f), 5e-3f) << capsules;
  }
}

SIM_TEST(Meeting, WhatBeginsDeepIsPartedWithoutSpeed) {
  for (const bool boxes : {true, false}) {
    BodiesApart two;
    two.add(boxes ? BodiesApart::box({0, 0, 0}, {0.3f, 0.3f, 0.3f}) : BodiesApart::sphere({0, 0, 0}, 0.2f),
            1);
    two.add(boxes ? BodiesApart::box({0.22f, 0, 0.01f}, {0.2f, 0.2f, 0.2f})
                  : BodiesApart::sphere({0.1f, 0, 0}, 0.2f),
            1);
    float fastest = 0;
    for (int step = 0; step < 200; ++step) {
      two.step();
      for (const Body& body : two.bodies) fastest = std::max(fastest, length(body.velocity));
    }
    EXPECT_LT(fastest, 0.1f * 0.05f / two.dt) << "a tenth of a spacing in a substep";
    EXPECT_GT(length(two.bodies[0].centre - two.bodies[1].centre), boxes ? 0.2495f : 0.3995f);
    EXPECT_EQ(length(two.velocity(0)), 0);
    EXPECT_EQ(two.energy(), 0);
  }
}

SIM_TEST(Meeting, WhatMovesPushesWithItsOwnSpeed) {
  BodiesApart two;
  two.add(BodiesApart::box({0, 0, 0}, {0.2f, 1, 1}), 0);
  two.add(BodiesApart::sphere({0.4f, 0, 0}, 0.2f), 1);
  for (int step = 0; step < 90; ++step) {
    two.bodies[0].velocity = {1, 0, 0};
    two.bodies[0].centre += two.dt * two.bodies[0].velocity;
    two.step();
    EXPECT_GT(two.bodies[1].centre.x - two.bodies[0].centre.x, 0.3f - 1e-4f);
  }
  EXPECT_NEAR(two.velocity(1).x, 1, 1e-4f);
  EXPECT_NEAR(two.bodies[1].centre.x - two.bodies[0].centre.x, 0.3f, 1e-3f) << "they touch";
}

SIM_TEST(Meeting, WhatTurnsPushesWithTheSpeedOfThePlace) {
  BodiesApart two;
  two.add(BodiesApart::box({0, 0, 0}, {2, 0.1f, 0.5f}), 0);
  two.add(BodiesApart::sphere({0.8f, 0.3f, 0}, 0.2f), 1);
  for (int step = 0; step < 45; ++step) {
    two.bodies[0].spin = {0, 0, 1};
    two.bodies[0].turn = turned_by(two.bodies[0].turn, {0, 0, two.dt});
    two.step();
    const float away = two.bodies[0].distance(two.bodies[1].centre);
    EXPECT_GT(away, 0.2f - 2e-3f) << step;
  }
  EXPECT_NEAR(length(two.velocity(1)), 0.8f, 0.1f);
}

SIM_TEST(Meeting, ABallRestsInAWedge) {
  for (const float degrees : {2.0f, 5.0f, 20.0f}) {
    const float angle = degrees * 1.57079633f / 90;  // between each side and the vertical
    const Vec3 middle{0, 2, 0};
    BodiesApart three;
    three.gravity = g;
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3 away{side * std::cos(angle), -std::sin(angle), 0};
      Body wall = BodiesApart::box(middle + 0.4f * away, {0.4f, 3, 1});
      wall.turn = turned_by(wall.turn, {0, 0, -side * angle});
      three.add(wall, 0);
    }
    three.add(BodiesApart::sphere(middle, 0.2f), 1);
    three.step(360);
    EXPECT_NEAR(three.bodies[2].centre.y, 2, 0.01f) << degrees;
    EXPECT_LT(length(three.velocity(2)), 1e-3f) << degrees;
  }
}

/// A box moves down through the floor and later up again, with a free body between it and the floor. Both
/// cannot be kept out: the floor has priority, and the body must not be flung away.
SIM_TEST(Meeting, WhatIsPinnedStaysInTheTank) {
  for (const bool box : {true, false}) {
    BodiesApart two;
    two.gravity = g;
    two.add_floor();
    two.add(BodiesApart::box({0, 1, 0}, {1, 0.2f, 1}), 0, 0.5f);
    two.add(
        box ? BodiesApart::box({0, 0.1f, 0}, {0.3f, 0.2f, 0.3f}) : BodiesApart::sphere({0, 0.2f, 0}, 0.2f), 1,
        0.5f);
    for (int step = 0; step < 180; ++step) {
      const float speed = step < 96 ? -1.5f : 1.5f;
      two.bodies[0].velocity = {0, speed, 0};
      two.bodies[0].centre += two.dt * two.bodies[0].velocity;
      two.step();
      const Vec3 v = two.velocity(1);
      ASSERT_TRUE(all_finite(v) && all_finite(two.bodies[1].centre) && all_finite(two.spin(1)));
      EXPECT_LT(length(v), 3) << step;
      EXPECT_GE(two.bodies[1].centre.y, box ? 0.0999f : 0.1999f);
      EXPECT_LT(length(two.bodies[1].centre), 0.5f);
    }
  }
}

/// Balls of masses 1 and 400 lie in two layers and more.
SIM_TEST(Meeting, AHeapOfHeavyAndLightBallsKeepsApart) {
  for (const float aside : {0.0f, 0.003f, 0.006f}) {
    BodiesApart heap;
    heap.gravity = g;
    heap.add_floor();
    for (const Vec3 normal : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}})
      heap.walls.planes[heap.walls.count++] = {normal, -0.5f};
    constexpr int balls = 14;
    for (int k = 0; k < balls; ++k) {
      const auto number = static_cast<float>(k);
      const Vec3 at{0.32f * static_cast<float>(k % 3 - 1) + aside * number,
                    0.3f + 0.36f * static_cast<float>(k / 3), (k % 2 ? 0.1f : -0.1f) + 0.7f * aside};
      heap.add(BodiesApart::sphere(at, 0.15f), k % 3 == 0 ? 400.0f : 1.0f, 0.5f);
    }
    float deepest = 0;
    float energy = heap.energy();
    for (int step = 0; step < 500; ++step) {
      heap.step();
      EXPECT_LT(heap.energy(), energy * 1.02f) << aside << " step " << step;
      energy = heap.energy();
      for (int a = 0; a < balls; ++a) {
        for (int b = 0; b < a; ++b) deepest = std::max(deepest, -heap.gap_of_balls(a, b));
      }
    }
    EXPECT_LT(deepest, 0.01f * 0.15f) << aside << ": a hundredth of the radius";
  }
}

SIM_TEST(Meeting, ACrowdOfAllShapesComesToRest) {
  for (const float mu : {0.0f, 0.5f}) {
    BodiesApart crowd;
    crowd.gravity = g;
    crowd.add_floor();
    for (const Vec3 normal : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}})
      crowd.walls.planes[crowd.walls.count++] = {normal, -0.5f};
    for (int k = 0; k < 12; ++k) {
      const auto at = static_cast<float>(k);
      Body body = k % 3 == 0   ? BodiesApart::capsule({0, 0, 0}, 0.08f, 0.2f)
                  : k % 3 == 1 ? BodiesApart::box({0, 0, 0}, {0.2f, 0.3f, 0.15f})
                               : BodiesApart::sphere({0, 0, 0}, 0.1f);
      body.centre = {k % 2 ? 0.25f : -0.25f, 0.3f + 0.4f * std::floor(at / 4), k / 2 % 2 ? 0.25f : -0.25f};
      body.turn = turned_by(body.turn, {0.3f * at, 0.7f * at, 0.1f});
      crowd.add(body, k % 4 == 1 ? 20.0f : 1.0f, mu);
    }
    float energy = crowd.energy();
    for (int step = 0; step < 500; ++step) {
      crowd.step();
      EXPECT_LT(crowd.energy(), energy * 1.005f) << mu << " step " << step;
      energy = crowd.energy();
    }
    float kinetic = energy, deepest = 0;
    for (std::size_t b = 0; b < crowd.bodies.size(); ++b) {
      kinetic -= crowd.frees[b].mass * g * crowd.bodies[b].centre.y;
      for (std::size_t other = 0; other < crowd.bodies.size(); ++other) {
        if (other == b) continue;
        const Feelers feelers{crowd.bodies[b], nullptr};
        for (int k = 0; k < feelers.corners(); ++k)
          deepest = std::max(deepest, crowd.bodies[b].radius -
                                          crowd.bodies[other].distance(feelers.in_world(feelers.corner(k))));
      }
      EXPECT_LT(crowd.bodies[b].centre.y, 0.8f);
    }
    EXPECT_LT(kinetic, mu > 0 ? 0.3f : 2.0f);
    EXPECT_LT(deepest, 2e-3f);
  }
}

}  // namespace

}  // namespace sim::SIM_BACKEND
