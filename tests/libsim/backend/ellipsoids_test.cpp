/// The ellipsoids by which particles are drawn, against closed forms.

#include <cmath>
#include <limits>
#include <random>

#include "libsim/surface/ellipsoids.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr float d = 0.1f, h = 2 * d, r = d / 2;

struct Drawn {
  std::vector<Vec4> centre;
  std::vector<Symmetric3> square;
  std::vector<RenderShape> shape;
};

/// A picture's particles at these places, in a tank of 10 m that they do not touch.
struct Water {
  Array<Vec4> position, velocity;
  Array<int> id;
  std::vector<Vec4> places;
  Domain tank{{-5, -5, -5}, {5, 5, 5}};
  bool lid = true;
  int most_ids = 4000;

  Drawn draw(Ellipsoids& by, const std::vector<Vec4>& at, const std::vector<int>& ids = {}, int frame = 0,
             float follow = 1, std::vector<Vec4> speeds = {}) {
    places = at;
    position.from_host(at);
    speeds.resize(at.size(), Vec4{0, 0, 0, 0});
    velocity.from_host(speeds);
    if (!ids.empty()) id.from_host(ids);
    const SurfaceParticles from{.n = static_cast<int>(at.size()),
                                .position = position.data(),
                                .velocity = velocity.data(),
                                .id = ids.empty() ? nullptr : id.data(),
                                .most_ids = most_ids,
                                .frame = frame,
                                .follow = follow,
                                .frame_s = 1 / 60.0f,
                                .support = h,
                                .tank = tank,
                                .lid = lid};
    Array<Vec4> centre(static_cast<std::size_t>(most_ids));
    Array<RenderShape> shape(static_cast<std::size_t>(most_ids));
    const auto n = static_cast<std::size_t>(by.compute(from, centre.data(), shape.data()));
    Drawn out{centre.to_host(), {}, shape.to_host()};
    out.centre.resize(n);
    out.shape.resize(n);
    for (const RenderShape& one : out.shape) out.square.push_back(unpacked(one));
    return out;
  }
  Drawn draw(const std::vector<Vec4>& at) {
    Ellipsoids by;
    return draw(by, at);
  }
};

/// A lattice with (2 nx + 1) (2 ny + 1) (2 nz + 1) places; the first is the origin.
std::vector<Vec4> lattice(int nx, int ny, int nz, bool below_only = false) {
  std::vector<Vec4> out{{0, 0, 0, h}};
  for (int y = -ny; y <= (below_only ? 0 : ny); ++y)
    for (int x = -nx; x <= nx; ++x)
      for (int z = -nz; z <= nz; ++z)
        if (x || y || z)
          out.push_back({d * static_cast<float>(x), d * static_cast<float>(y), d * static_cast<float>(z), h});
  return out;
}

SIM_TEST(Ellipsoids, InsideWaterAreBallsOfTheirVolume) {
  const Drawn drawn = Water().draw(lattice(4, 4, 4));
  const float a = 1.5f * r;
  const Symmetric3& s = drawn.square[0];
  for (const float axis : {s.xx, s.yy, s.zz}) EXPECT_NEAR(axis, a * a, 1e-3f * a * a);
  for (const float other : {s.xy, s.xz, s.yz}) EXPECT_NEAR(other, 0, 1e-3f * a * a);
  EXPECT_LT(length(xyz(drawn.centre[0])), 1e-3f * d);
  EXPECT_EQ(drawn.centre[0].w, r);
}

SIM_TEST(Ellipsoids, OnAPlaneLieFlatAndReachItsSurface) {
  const Drawn drawn = Water().draw(lattice(4, 6, 4, true));
  const Symmetric3& s = drawn.square[0];
  EXPECT_LT(s.yy, 0.4f * s.xx) << "flat along the normal";
  EXPECT_NEAR(s.xx, s.zz, 1e-2f * s.xx);
  EXPECT_LT(std::abs(s.xy) + std::abs(s.yz), 1e-3f * s.xx) << "the normal is an axis";
  // The surface of water at rest lies half a spacing above the upper layer.
  EXPECT_NEAR(drawn.centre[0].y + std::sqrt(s.yy), d / 2, 0.03f * d);
  EXPECT_LT(std::hypot(drawn.centre[0].x, drawn.centre[0].z), 1e-3f * d);
}

SIM_TEST(Ellipsoids, APlaneIsFlatInAnyDirection) {
  auto places = lattice(4, 6, 4, true);
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  for (Vec4& p : places) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z, p.w};
  const Drawn drawn = Water().draw(places);
  const Vec3 normal{-s, c, 0};
  const Eigen3 eigen(drawn.square[0]);
  EXPECT_NEAR(std::abs(dot(eigen.axis[2], normal)), 1, 1e-4f);
  EXPECT_NEAR(dot(xyz(drawn.centre[0]), normal) + std::sqrt(eigen.value[2]), d / 2, 0.03f * d);
}

SIM_TEST(Ellipsoids, AParticleThatStandsOutIsMovedTowardsThePlane) {
  auto places = lattice(4, 6, 4, true);
  places[0].y += 0.3f * d;
  const Drawn drawn = Water().draw(places);
  const float top = drawn.centre[0].y + std::sqrt(drawn.square[0].yy);
  EXPECT_LT(top, d / 2 + 0.2f * d);
  EXPECT_GT(top, d / 2 - 0.05f * d);
}

SIM_TEST(Ellipsoids, AreLongAlongAThreadAndSmallAlone) {
  auto places = lattice(6, 0, 0);
  places.push_back({2, 2, 2, h});
  const Drawn drawn = Water().draw(places);
  EXPECT_GT(drawn.square[0].xx, 1.2f * drawn.square[0].yy);
  const Symmetric3& alone = drawn.square.back();
  EXPECT_NEAR(alone.xx, 0.64f * r * r, 1e-3f * r * r) << "0.8 of the radius";
  EXPECT_NEAR(alone.yy, alone.xx, 1e-4f * r * r);
  EXPECT_EQ(drawn.centre.back().x, 2);
}

SIM_TEST(Ellipsoids, ADropIsStretchedAlongItsMotionAtConstantVolume) {
  Ellipsoids by;
  Water water;
  const Drawn drawn = water.draw(by, {{0, 0, 0, h}}, {}, 0, 1, {{0, 60 * r, 0, 0}});
  const Symmetric3& s = drawn.square[0];
  EXPECT_NEAR(std::sqrt(s.yy) / (0.8f * r), 1.25f, 0.01f) << "a quarter of the way in a frame over r";
  EXPECT_NEAR(s.xx * s.yy * s.zz, std::pow(0.64f * r * r, 3.0f), 1e-2f * std::pow(0.64f * r * r, 3.0f));
}

SIM_TEST(Ellipsoids, WallsMirrorTheWaterButAnOpenTopDoesNot) {
  // The lattice fills a corner of the tank: floor, and the walls x and z.
  std::vector<Vec4> places;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      for (int z = 0; z < 6; ++z)
        places.push_back({d * (static_cast<float>(x) + 0.5f), d * (static_cast<float>(y) + 0.5f),
                          d * (static_cast<float>(z) + 0.5f), h});
  Water water;
  water.tank = {{0, 0, 0}, {10, 6 * d, 10}};
  const auto corner = [&] { return water.draw(places).square[0]; };
  const float a = 1.5f * r;
  EXPECT_NEAR(corner().yy, a * a, 1e-3f * a * a) << "inside water, as its mirror images say";
  const std::size_t top = 5 * 36;
  EXPECT_NEAR(water.draw(places).square[top].yy, a * a, 1e-3f * a * a) << "under a lid";
  water.lid = false;
  const Drawn open = water.draw(places);
  EXPECT_LT(open.square[top].yy, 0.4f * open.square[top].xx);
}

SIM_TEST(Ellipsoids, DoNotDependOnTheOrderAndRepeatBitForBit) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-0.5f, 0.5f);
  std::vector<Vec4> places, reversed;
  for (int i = 0; i < 1500; ++i)
    places.push_back({at(random), at(random), at(random), h * std::cbrt(static_cast<float>(1 << i % 4))});
  const Drawn once = Water().draw(places), again = Water().draw(places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 4; ++k) ASSERT_EQ(once.shape[i].word[k], again.shape[i].word[k]);
    ASSERT_EQ(once.centre[i].x, again.centre[i].x);
  }
  reversed.assign(places.rbegin(), places.rend());
  const Drawn other = Water().draw(reversed);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 moved = xyz(once.centre[i]) - xyz(other.centre[places.size() - 1 - i]);
    ASSERT_LT(length(moved), 1e-4f * d);
  }
}

SIM_TEST(Ellipsoids, UnusedSlotsStayUnused) {
  auto places = lattice(3, 3, 3);
  places.push_back({0, 0, 0, 0});
  const Drawn drawn = Water().draw(places);
  EXPECT_EQ(drawn.centre.back().w, 0);
  EXPECT_EQ(drawn.centre[0].w, r);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) ASSERT_TRUE(all_finite(xyz(drawn.centre[i])));
}

SIM_TEST(Ellipsoids, AreFiniteForParticlesAtOnePlaceAndForAnySpeed) {
  Ellipsoids by;
  Water water;
  const float infinite = std::numeric_limits<float>::infinity();
  std::vector<Vec4> places(20, Vec4{1, 1, 1, h}), speeds(20, Vec4{0, 0, 0, 0});
  places.push_back({3, 3, 3, h});
  speeds.push_back({infinite, 0, 0, 0});
  const Drawn drawn = water.draw(by, places, {}, 0, 1, speeds);
  for (const Symmetric3& s : drawn.square) {
    for (const float value : {s.xx, s.yy, s.zz, s.xy, s.xz, s.yz}) ASSERT_TRUE(std::isfinite(value));
    ASSERT_GT(s.xx, 0);
  }
}

SIM_TEST(Ellipsoids, FollowInEqualStepsAndMergedParticlesFadeOut) {
  Ellipsoids by;
  Water water;
  auto places = lattice(4, 4, 4);
  std::vector<int> ids;
  for (std::size_t i = 0; i < places.size(); ++i) ids.push_back(static_cast<int>(i));
  const auto first = water.draw(by, places, ids, 7, 0.25f);
  // Particle 0 jumps, and the last one has gone.
  places[0].x += 0.5f * d;
  places.pop_back();
  ids.pop_back();
  const float target = water.draw(places).centre[0].x;
  float before = 0;
  for (int k = 1; k <= 4; ++k) {
    const auto now = water.draw(by, places, ids, 7 + k, 1 / static_cast<float>(5 - k));
    EXPECT_NEAR(now.centre[0].x, target * static_cast<float>(k) / 4, 0.02f * d) << k;
    EXPECT_GT(now.centre[0].x, before);
    before = now.centre[0].x;
    ASSERT_EQ(now.centre.size(), places.size() + (k < 4));
    if (k == 4) continue;
    const float share = now.square.back().xx / first.square.back().xx;
    EXPECT_NEAR(share, 1 - static_cast<float>(k) / 4, 1e-3f) << "it fades out in equal steps";
    EXPECT_EQ(now.centre.back().x, first.centre.back().x);
  }
}

SIM_TEST(Ellipsoids, OfFastWaterDoNotBlendAndDoNotFadeOut) {
  const SurfaceRules rules;
  // The error of particle 0 in the first frame of a change of levels, in units of its jump, and whether the
  // particle that has gone is drawn. All water moves by `way` radii in a frame.
  struct Outcome {
    float lag;
    bool fades;
  };
  const auto outcome = [&](float way) {
    Ellipsoids by;
    Water water;
    auto places = lattice(4, 4, 4);
    std::vector<int> ids;
    for (std::size_t i = 0; i < places.size(); ++i) ids.push_back(static_cast<int>(i));
    const std::vector<Vec4> speeds(places.size(), Vec4{0, 60 * way * r, 0, 0});
    water.draw(by, places, ids, 7, 0.25f, speeds);
    for (Vec4& place : places) place.y += way * r;
    places[0].x += 0.5f * d;
    places.pop_back();
    ids.pop_back();
    const float target = water.draw(places).centre[0].x;
    const Drawn now = water.draw(by, places, ids, 8, 0.25f, speeds);
    return Outcome{(target - now.centre[0].x) / target, now.centre.size() > places.size()};
  };
  EXPECT_NEAR(outcome(rules.slow).lag, 0.75f, 0.01f);
  EXPECT_TRUE(outcome(rules.slow).fades);
  EXPECT_NEAR(outcome(0.5f * (rules.slow + rules.fast)).lag, 0.375f, 0.01f);
  EXPECT_NEAR(outcome(1.01f * rules.fast).lag, 0, 1e-4f);
  EXPECT_FALSE(outcome(1.01f * rules.fast).fades);
}

SIM_TEST(Ellipsoids, AFrameDrawnTwiceIsTheSameAndAJumpBlendsNothing) {
  Ellipsoids by;
  Water water;
  auto places = lattice(4, 4, 4);
  std::vector<int> ids;
  for (std::size_t i = 0; i < places.size(); ++i) ids.push_back(static_cast<int>(i));
  water.draw(by, places, ids, 7, 0.25f);
  places[0].x += 0.5f * d;
  const auto once = water.draw(by, places, ids, 8, 0.25f), again = water.draw(by, places, ids, 8, 0.25f);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (int k = 0; k < 4; ++k) ASSERT_EQ(once.shape[i].word[k], again.shape[i].word[k]);
  const float target = water.draw(places).centre[0].x;
  EXPECT_EQ(water.draw(by, places, ids, 20, 0.25f).centre[0].x, target);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
