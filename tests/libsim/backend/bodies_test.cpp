/// Shapes of obstacles in device code: distances, normals, and the share of an SPH kernel that lies in a
/// body, against brute force.

#include "libsim/particles/solids.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/particles/kernels.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {

namespace {

Body sphere(float radius) {
  Body out{};
  out.radius = radius;
  out.turn = {0, 0, 0, 1};
  return out;
}
Body capsule(float radius, float half) {
  Body out = sphere(radius);
  out.half = {0, half, 0};
  return out;
}
Body box(Vec3 half) {
  Body out{};
  out.half = half;
  out.turn = {0, 0, 0, 1};
  return out;
}

/// Share of poly6's weight about x that lies in the body, summed over a fine lattice.
double share_by_sum(const Body& body, Vec3 x, float h) {
  const Kernel kernel(h);
  constexpr int n = 60;
  double inside = 0, all = 0;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      for (int c = 0; c < n; ++c) {
        const auto at = [&](int k) { return h * (2 * (static_cast<float>(k) + 0.5f) / n - 1); };
        const Vec3 from{at(a), at(b), at(c)};
        const auto weight = static_cast<double>(kernel.density(dot(from, from)));
        all += weight;
        if (body.distance(x + from) < 0) inside += weight;
      }
    }
  }
  return inside / all;
}

SIM_TEST(Bodies, ShareOfASphereIsExact) {
  for (const float radius : {0.3f, 1.0f, 4.0f}) {
    for (const float q : {0.05f, 0.3f, 0.7f}) {
      const Vec3 normal{0.6f, 0.64f, 0.48f};  // along no plane of the sum's lattice
      const Vec3 x = (radius + q) * normal;
      Vec3 gradient;
      const float share = sphere(radius).missing(x, 1, gradient);
      EXPECT_NEAR(share, share_by_sum(sphere(radius), x, 1), 0.003) << radius << " " << q;
      EXPECT_NEAR(-dot(gradient, normal), length(gradient), 1e-5f);
      EXPECT_GT(length(gradient), 0.0f);
    }
  }
}

SIM_TEST(Bodies, AGreatSphereIsAPlane) {
  for (const float q : {0.0f, 0.2f, 0.6f, 0.9f}) {
    const SphereShare share{q, 1e3f};
    EXPECT_NEAR(share.inside(), Walls::behind(q), 1e-3f);
    EXPECT_NEAR(share.slope(), Walls::slope(q), 5e-3f);
  }
}

SIM_TEST(Bodies, CapsulesAndBoxesComeNear) {
  const Body bodies[] = {capsule(0.8f, 1.5f), box({0.4f, 1, 2}), box({2, 2, 2})};
  const Vec3 places[] = {{1.0f, 0.2f, 0.1f}, {0.4f, 2.3f, 0.3f}, {0.6f, 1.1f, 0.2f},
                         {2.1f, 2.2f, 0.1f}, {2.2f, 2.1f, 2.1f}, {0.1f, 1.3f, 0.0f}};
  for (const Body& body : bodies) {
    for (const Vec3 x : places) {
      if (body.distance(x) < 0 || body.distance(x) > 1) continue;
      Vec3 gradient;
      EXPECT_NEAR(body.missing(x, 1, gradient), share_by_sum(body, x, 1), 0.035) << x.x << " " << x.y;
    }
  }
}

SIM_TEST(Bodies, NormalsAreGradientsOfTheDistance) {
  Body body = box({0.5f, 0.8f, 0.3f});
  body.centre = {1, 2, 3};
  body.turn = {0.2f, 0.4f, 0.4f, 0.8f};
  for (const Vec3 x : {Vec3{2, 2.5f, 3.2f}, Vec3{0.9f, 3.4f, 3.1f}, Vec3{1.2f, 2.1f, 3.05f}}) {
    const Body::Near near = body.near(x);
    constexpr float step = 1e-3f;
    const Vec3 slope =
        (1 / (2 * step)) * Vec3{body.distance(x + Vec3{step, 0, 0}) - body.distance(x - Vec3{step, 0, 0}),
                                body.distance(x + Vec3{0, step, 0}) - body.distance(x - Vec3{0, step, 0}),
                                body.distance(x + Vec3{0, 0, step}) - body.distance(x - Vec3{0, 0, step})};
    EXPECT_LT(length(slope - near.normal), 5e-3f);
  }
}

SIM_TEST(Bodies, HoldBackRidesWithAMovingBody) {
  Body body = box({0.5f, 5, 5});
  body.centre = {1.1f, 0, 0};  // moved here from 1.0 in 0.1 s
  body.velocity = {1, 0, 0};
  Solids solids{.walls = {}, .bodies = &body, .count = 1, .dt = 0.1f};
  Vec3 x{1.54f, 0, 0};  // 0.04 from the face at its old position
  EXPECT_TRUE(solids.hold_back(x, x, 0));
  EXPECT_NEAR(x.x, 1.61f, 1e-5f) << "a quarter of the distance stays";
  Vec3 ahead{1.7f, 0, 0};
  EXPECT_FALSE(solids.hold_back(ahead, ahead, 0));
}

SIM_TEST(Bodies, ProjectionLeavesNobodyInside) {
  const Body bodies[] = {sphere(1), box({0.2f, 0.2f, 3})};
  const Solids solids{.walls = {}, .bodies = bodies, .count = 2, .dt = 0};
  for (int k = 0; k < 200; ++k) {
    const auto angle = static_cast<float>(k);
    Vec3 x{0.9f * std::cos(angle), 0.9f * std::sin(1.3f * angle), 0.5f * std::cos(2.1f * angle)};
    solids.project(x, x, 0.01f);
    Vec3 again = x;
    solids.project(again, x, 0.01f);
    EXPECT_GT(bodies[1].distance(again), 0.0f);
  }
}

}  // namespace

}  // namespace sim::SIM_BACKEND
