/// Foam: where it comes from, how it moves, and its books. Kernels on small crowds against sums on the host.

#include <cmath>
#include <numeric>
#include <random>

#include "libsim/foam/motion.hpp"
#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

using Speed = Vec3 (*)(Vec3);

/// Water of these places and supports in a tank of 4 m, sorted by the grid, with a pool of `most`.
struct Water {
  FluidState state;
  FoamRules rules;

  Water(const std::vector<Vec4>& points, bool one_level, Speed speed, int most = 4096) {
    state.guards.resize(1);
    state.guards.zero();
    state.one_level = one_level;
    state.supports = level_supports(0.2);
    state.lightest_support = points.empty() ? 0.2f : points[0].w;
    state.domain = {{0, 0, 0}, {4, 4, 4}};
    auto& p = state.particles;
    p.allocate(all_columns(), static_cast<int>(points.size()));
    std::vector<int> id(points.size());
    std::iota(id.begin(), id.end(), 0);
    std::vector<std::uint8_t> level;
    std::vector<Vec4> velocity;
    for (const Vec4& x : points) {
      level.push_back(one_level ? 0 : static_cast<std::uint8_t>(std::lround(3 * std::log2(x.w / 0.2f))));
      velocity.push_back(with_w(speed(xyz(x)), 0));
    }
    p.all().position.from_host(points);
    p.all().predicted.from_host(points);
    p.all().velocity.from_host(velocity);
    p.all().id.from_host(id);
    p.all().level.from_host(level);
    find_neighbours(state, NeighboursView(p));
    state.foam.begin(most, static_cast<int>(points.size()));
    state.foam.approach.resize(points.size());
    rules.dt = 0.02f;
    rules.rate = 1;
    rules.approach = rules.crest = {1e9f, 1};
    rules.energy = {0, 1e-6f};
    rules.volume = 1e-6f;
  }

  FoamView view() { return FoamView(state.particles); }
  std::vector<int> births() {
    find_foam_surface(state.foam, view(), state.grid, state.walls, rules);
    count_foam_births(state.foam, view(), state.grid, rules);
    return state.foam.births.to_host();
  }
  void emit() {
    births();
    emit_foam(state.foam, view(), state.walls, rules);
  }
  void move() { move_foam(state.foam, view(), state.grid, state.walls, rules); }
  FoamLedger ledger() { return state.foam.ledger.to_host()[0]; }
  std::uint64_t alive() {
    std::uint64_t out = 0;
    for (const Vec4& x : state.foam.place.to_host()) out += x.w > 0;
    return out;
  }
};

/// Lattice points of spacing h / 2 in [low, high]^3.
std::vector<Vec4> cube(float low, float high, float h) {
  std::vector<Vec4> out;
  const float d = h / 2;
  for (float x = low + d / 2; x < high; x += d)
    for (float y = low + d / 2; y < high; y += d)
      for (float z = low + d / 2; z < high; z += d) out.push_back({x, y, z, h});
  return out;
}

std::vector<Vec4> mixed_crowd() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(1, 2);
  std::vector<Vec4> out;
  for (int i = 0; i < 400; ++i)
    out.push_back({at(random), at(random), at(random), 0.2f * std::exp2(static_cast<float>(i % 4) / 3)});
  return out;
}

Vec3 stirred(Vec3 x) { return {3 + std::sin(9 * x.y), std::cos(7 * x.z), std::sin(5 * x.x + x.y)}; }

SIM_TEST(Foam, SurfaceAndApproachAreTheSumsOverAllPairs) {
  Water water(mixed_crowd(), false, stirred);
  water.births();
  const auto x = water.state.particles.all().position.to_host();
  const auto v = water.state.particles.all().velocity.to_host();
  const auto normal = water.state.particles.all().normal.to_host();
  const auto approach = water.state.foam.approach.to_host();
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3 n{};
    double met = 0;
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Kernel kernel((x[i].w + x[j].w) / 2);
      const Vec3 offset = xyz(x[i]) - xyz(x[j]);
      const float r = length(offset);
      if (j == i || r >= kernel.h) continue;
      const Vec3 along = xyz(v[i]) - xyz(v[j]);
      const float t = kernel.h2 - r * r;
      n += (x[i].w * mass_of(x[j].w, 1) * 6 * kernel.poly6 * t * t) * offset;
      const float speed = length(along);
      if (speed > 0)
        met += static_cast<double>(mass_of(x[j].w, 1) * kernel.density(r * r) * speed *
                                   (1 - dot(along, offset) / (speed * r)) / r);
    }
    EXPECT_LT(length(n - xyz(normal[i])), 2e-4f * (1 + length(n)));
    met /= 1 - static_cast<double>(mass_of(1, 1) * Kernel(1).density(0));
    EXPECT_NEAR(static_cast<double>(approach[i]), met, 2e-4 * (1 + met));
  }
}

/// Volume of the births over rate, time and the water's volume.
double emitted_share(const std::vector<int>& births, const Water& water, double volume) {
  const double all = std::accumulate(births.begin(), births.end(), 0.0);
  return all * static_cast<double>(water.rules.volume / (water.rules.rate * water.rules.dt)) / volume;
}

SIM_TEST(Foam, TheVolumeAtFullPotentialIsTheRateForFineAndForCoarseWater) {
  for (const float h : {0.2f, 0.4f}) {
    Water water(cube(1, 2, h), true, [](Vec3 x) { return Vec3{5, 0, 3 * (x.x - 1.5f)}; });
    water.rules.approach = {0, 1e-6f};
    EXPECT_NEAR(emitted_share(water.births(), water, 1), 1, 0.02) << h;
    // The middle of the water alone turns at half of its potential.
    water.rules.approach = {0, 1e4f};
    const double some = emitted_share(water.births(), water, 1);
    water.rules.rate *= 2;
    EXPECT_NEAR(emitted_share(water.births(), water, 1), some, 0.1 * some + 1e-3) << h;
  }
}

SIM_TEST(Foam, SlowWaterAndWaterThatMovesAsOneMakeNone) {
  Water still(cube(1, 2, 0.2f), true, [](Vec3 x) { return Vec3{0.1f * x.y, 0, 0}; });
  still.rules.approach = still.rules.crest = {0, 1e-6f};
  still.rules.energy = {1, 1};
  const auto none = still.births();
  EXPECT_EQ(std::accumulate(none.begin(), none.end(), 0), 0);
  Water one(cube(1, 2, 0.2f), true, [](Vec3) { return Vec3{5, 0, 0}; });
  one.rules.approach = {0, 1e-3f};
  const auto also_none = one.births();
  EXPECT_EQ(std::accumulate(also_none.begin(), also_none.end(), 0), 0);
}

SIM_TEST(Foam, CrestsAreConvexAndPushedOn) {
  // A block's edges and corners in front of its motion, and none at its back or on its faces' middles.
  Water water(cube(1, 2, 0.2f), true, [](Vec3) { return Vec3{5, 0, 0}; });
  water.rules.crest = {0.3f, 1e-6f};
  const auto births = water.births();
  const auto x = water.state.particles.all().position.to_host();
  int at_the_rim = 0;
  for (std::size_t i = 0; i < births.size(); ++i) {
    if (births[i] == 0) continue;
    EXPECT_GT(x[i].x, 1.8f);
    const bool in_the_middle = std::abs(x[i].y - 1.5f) < 0.2f && std::abs(x[i].z - 1.5f) < 0.2f;
    EXPECT_FALSE(in_the_middle);
    ++at_the_rim;
  }
  EXPECT_GT(at_the_rim, 20);
}

SIM_TEST(Foam, CoarserLevelsThanItsDetailMakeNone) {
  Water water(mixed_crowd(), false, stirred);
  water.rules.approach = {0, 1e-6f};
  water.rules.coarsest = 1;
  const auto births = water.births();
  const auto level = water.state.particles.all().level.to_host();
  int fine = 0;
  for (std::size_t i = 0; i < births.size(); ++i) {
    EXPECT_TRUE(level[i] <= 1 || births[i] == 0);
    fine += births[i];
  }
  EXPECT_GT(fine, 100);
}

SIM_TEST(Foam, WaterTwoLevelsTooCoarseIsNotLookedAt) {
  Water all(mixed_crowd(), false, stirred);
  all.births();
  const auto whole = all.state.foam.approach.to_host();
  Water fine(mixed_crowd(), false, stirred);
  fine.rules.coarsest = 0;
  fine.rules.coarsest_seen = 1;
  fine.births();
  const auto approach = fine.state.foam.approach.to_host();
  const auto normal = fine.state.particles.all().normal.to_host();
  const auto level = fine.state.particles.all().level.to_host();
  int left_out = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    EXPECT_EQ(approach[i], level[i] <= 1 ? whole[i] : 0);
    if (level[i] <= 1) continue;
    EXPECT_EQ(length(xyz(normal[i])), 0);
    left_out += whole[i] > 0;
  }
  EXPECT_GT(left_out, 100);
}

SIM_TEST(Foam, AFullPoolDropsAnEvenShareAndTheBooksClose) {
  Water water(
      cube(1, 2, 0.2f), true,
      [](Vec3 x) {
        return Vec3{5, 0, 3 * (x.x - 1.5f)};
      },
      100);
  water.rules.approach = {0, 1e-6f};
  const auto births = water.births();
  const auto asked = static_cast<std::uint64_t>(std::accumulate(births.begin(), births.end(), 0));
  ASSERT_GT(asked, 150u);
  water.emit();
  EXPECT_EQ(water.ledger().emitted, asked);
  EXPECT_EQ(water.ledger().dropped, asked - 100);
  EXPECT_EQ(water.alive(), 100u);
  double middle = 0;
  for (const Vec4& at : water.state.foam.place.to_host()) middle += static_cast<double>(at.y) / 100;
  EXPECT_NEAR(middle, 1.5, 0.1) << "chosen from all of the water";
  water.emit();
  EXPECT_EQ(water.ledger().dropped, 2 * asked - 100);
  EXPECT_EQ(water.alive(), 100u);
}

/// One diffuse particle at x with velocity v.
void put(Water& water, Vec4 x, Vec3 v) {
  auto place = water.state.foam.place.to_host();
  auto velocity = water.state.foam.velocity.to_host();
  place[0] = x;
  velocity[0] = with_w(v, 1);
  water.state.foam.place.from_host(place);
  water.state.foam.velocity.from_host(velocity);
}

SIM_TEST(Foam, SprayFallsAgainstTheAirsDrag) {
  Water water({{1, 1, 1, 0.2f}}, true, [](Vec3) { return Vec3{}; });
  water.rules.gravity = 9.81f;
  water.rules.air_drag = 2;
  put(water, {3, 3, 3, 1}, {1, 0, 0});
  for (int k = 0; k < 10; ++k) water.move();
  const Vec4 v = water.state.foam.velocity.to_host()[0];
  const float kept = std::exp(-2.0f * 10 * water.rules.dt);
  EXPECT_NEAR(v.x, kept, 1e-5f);
  EXPECT_NEAR(v.y, -9.81f / 2 * (1 - kept), 1e-4f);
  EXPECT_EQ(v.w, 0);
  EXPECT_EQ(water.state.foam.place.to_host()[0].w, 1) << "it ages on the water only";
}

SIM_TEST(Foam, BubblesComeToRiseAtTheirSpeed) {
  Water water(cube(1, 3, 0.4f), true, [](Vec3) { return Vec3{0.3f, 0, 0}; });
  water.rules.gravity = 9.81f;
  water.rules.rise = 0.25f;
  put(water, {1.8f, 1.6f, 2, 1}, {});
  for (int k = 0; k < 30; ++k) water.move();
  const Vec4 v = water.state.foam.velocity.to_host()[0];
  EXPECT_GT(v.w, FoamKinds::bubble);
  EXPECT_NEAR(v.y, 0.25f, 1e-4f);
  EXPECT_NEAR(v.x, 0.3f, 1e-3f);
}

SIM_TEST(Foam, RestsOnTheSurfaceAndDissolvesInItsTime) {
  Water water(cube(1, 2, 0.2f), true, [](Vec3) { return Vec3{}; });
  water.rules.lifetime = 1;
  put(water, {1.5f, 2, 1.5f, 0.5f}, {});
  for (int k = 0; k < 24; ++k) water.move();
  ASSERT_EQ(water.alive(), 1u);
  EXPECT_NEAR(water.state.foam.velocity.to_host()[0].w, 0.5f, 0.1f) << "half of the water is there";
  EXPECT_EQ(water.state.foam.place.to_host()[0].y, 2);
  for (int k = 0; k < 2; ++k) water.move();
  EXPECT_EQ(water.alive(), 0u);
  EXPECT_EQ(water.ledger().dissolved, 1u);
}

SIM_TEST(Foam, WallsHideNoWaterAndHoldWhatIsThrownAtThem) {
  Water water(cube(0, 1, 0.2f), true, [](Vec3) { return Vec3{}; });
  water.state.walls.planes[water.state.walls.count++] = {{1, 0, 0}, 0};
  put(water, {0.01f, 0.5f, 0.5f, 1}, {});
  water.rules.rise = 0.25f;
  water.move();
  EXPECT_GT(water.state.foam.velocity.to_host()[0].w, FoamKinds::bubble);
  put(water, {0.01f, 3, 3, 1}, {-5, 0, 0});
  water.move();
  EXPECT_EQ(water.state.foam.place.to_host()[0].x, 0);
  EXPECT_EQ(water.state.foam.velocity.to_host()[0].x, -0.5f);
  water.move();
  EXPECT_EQ(water.state.foam.velocity.to_host()[0].x, 0);
}

/// A sphere of radius 0.5 in the tank's middle, or a box of that half side.
Body body(bool round) {
  Body out{};
  (round ? out.radius : out.half.x) = 0.5f;
  if (!round) out.half = {0.5f, 0.5f, 0.5f};
  out.centre = {2, 2, 2};
  out.turn = {0, 0, 0, 1};
  return out;
}
Solids with_body(Water& water, const Body& of) {
  water.state.obstacles.bodies.from_host({of});
  return water.state.solids();
}

SIM_TEST(Foam, ObstaclesHoldWhatIsThrownAtThemAndTakeItAlong) {
  Water water({{1, 1, 1, 0.2f}}, true, [](Vec3) { return Vec3{}; });
  const Solids solids = with_body(water, body(true));
  const auto move = [&] { move_foam(water.state.foam, water.view(), water.state.grid, solids, water.rules); };
  put(water, {2.6f, 2, 2, 1}, {-20, 0, 0});
  move();
  EXPECT_NEAR(water.state.foam.place.to_host()[0].x, 2.5f, 1e-6f);
  EXPECT_NEAR(water.state.foam.velocity.to_host()[0].x, -5, 1e-4f);
  // One that has come over it.
  put(water, {2, 2.3f, 2, 1}, {});
  move();
  EXPECT_NEAR(water.state.foam.place.to_host()[0].y, 2.5f, 1e-6f);
  EXPECT_NEAR(water.state.foam.velocity.to_host()[0].y, 10, 1e-4f);
  move();
  EXPECT_NEAR(water.state.foam.place.to_host()[0].y, 2.7f, 1e-4f);
}

SIM_TEST(Foam, ObstaclesHideNoWater) {
  auto points = cube(1, 3, 0.2f);
  const Body box = body(false);
  std::erase_if(points, [&](const Vec4& x) { return box.distance(xyz(x)) < 0; });
  Water water(points, true, [](Vec3) { return Vec3{}; });
  const Solids solids = with_body(water, box);
  water.rules.rise = 0.25f;
  put(water, {2.5f, 2, 2, 1}, {});
  water.move();
  EXPECT_NEAR(water.state.foam.velocity.to_host()[0].w, 0.5f, 0.1f) << "to who knows of no obstacle";
  put(water, {2.5f, 2, 2, 1}, {});
  move_foam(water.state.foam, water.view(), water.state.grid, solids, water.rules);
  EXPECT_GT(water.state.foam.velocity.to_host()[0].w, FoamKinds::bubble);
  // Nor is there a surface.
  const auto normal_beside = [&](const auto& bounds) {
    find_foam_surface(water.state.foam, water.view(), water.state.grid, bounds, water.rules);
    const auto x = water.state.particles.all().position.to_host();
    const auto n = water.state.particles.all().normal.to_host();
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (length(xyz(x[i]) - Vec3{2.55f, 2, 2}) < length(xyz(x[nearest]) - Vec3{2.55f, 2, 2})) nearest = i;
    }
    return length(xyz(n[nearest]));
  };
  water.rules.energy = {-1, 1e-6f};
  EXPECT_GT(normal_beside(water.state.walls), 0.6f);
  EXPECT_LT(normal_beside(solids), 0.2f);
}

SIM_TEST(Foam, IsBornOutsideObstacles) {
  auto points = cube(1, 3, 0.2f);
  const Body box = body(false);
  std::erase_if(points, [&](const Vec4& x) { return box.distance(xyz(x)) < 0; });
  const auto born_inside = [&](bool known) {
    Water water(points, true, stirred, 100000);
    const Solids solids = with_body(water, box);
    water.rules.approach = {0, 1e-6f};
    water.rules.volume = 1e-6f;
    water.births();
    known ? emit_foam(water.state.foam, water.view(), solids, water.rules)
          : emit_foam(water.state.foam, water.view(), water.state.walls, water.rules);
    int inside = 0;
    for (const Vec4& x : water.state.foam.place.to_host()) inside += x.w > 0 && box.distance(xyz(x)) < -1e-5f;
    return inside;
  };
  EXPECT_GT(born_inside(false), 50);
  EXPECT_EQ(born_inside(true), 0);
}

SIM_TEST(Foam, WhatIsNotFiniteLeaves) {
  Water water({{1, 1, 1, 0.2f}}, true, [](Vec3) { return Vec3{}; });
  put(water, {3, 3, 3, 1}, {NAN, 0, 0});
  water.move();
  EXPECT_EQ(water.alive(), 0u);
  EXPECT_EQ(water.ledger().left, 1u);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
