/// Foam: births, motion and counts. Kernels on small sets of particles against sums on the host.

#include <cmath>

#include "tests/libsim/backend/foam_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

using namespace foam_crowds;

SIM_TEST(Foam, NormalsAreTheSumsOverAllPairs) {
  Water water(mixed_crowd(), false, stirred);
  water.births();
  const auto x = water.state.particles.all().position.to_host();
  const auto normal = water.state.particles.all().normal.to_host();
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3 n{};
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Kernel kernel((x[i].w + x[j].w) / 2);
      const Vec3 offset = xyz(x[i]) - xyz(x[j]);
      const float r = length(offset);
      if (j == i || r >= kernel.h) continue;
      const float t = kernel.h2 - r * r;
      n += (x[i].w * mass_of(x[j].w, 1) * 6 * kernel.poly6 * t * t) * offset;
    }
    EXPECT_LT(length(n - xyz(normal[i])), 2e-4f * (1 + length(n)));
  }
}

/// Approach rate in the middle of a block of water, 1/s.
float approach_in(Speed speed, float h) {
  Water water(cube(1, 3, h), true, speed);
  water.rules.energy = {-1, 1e-6f};
  water.births();
  const auto x = water.state.particles.all().position.to_host();
  const auto approach = water.state.foam.approach.to_host();
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (length(xyz(x[i]) - Vec3{2, 2, 2}) > 0.3f) continue;
    sum += static_cast<double>(approach[i]);
    ++count;
  }
  return static_cast<float>(sum / count);
}

SIM_TEST(Foam, WaterMeetsAsItsGradientSays) {
  // The expected value is the mean of |G e| - e G e over all directions e, where G is the gradient of the
  // velocity.
  for (const float h : {0.2f, 0.4f}) {
    EXPECT_NEAR(approach_in([](Vec3 x) { return -3 * (x - Vec3{2, 2, 2}); }, h), 6, 0.3f) << "from all sides";
    EXPECT_NEAR(approach_in([](Vec3 x) { return 3 * (x - Vec3{2, 2, 2}); }, h), 0, 1e-3f) << "it parts";
    EXPECT_NEAR(approach_in([](Vec3 x) { return Vec3{4 * x.z, 0, -4 * x.x}; }, h), pi, 0.15f) << "it turns";
    EXPECT_NEAR(approach_in([](Vec3 x) { return Vec3{0, 4 * x.x, 0}; }, h), 2, 0.2f) << "shear";
    EXPECT_NEAR(approach_in([](Vec3) { return Vec3{3, 2, 1}; }, h), 0, 1e-4f) << "it moves as one";
  }
}

SIM_TEST(Foam, CellsThatTheFarWallsCutAreNoDrierThanOthers) {
  // Water rotates in a corner of the tank, and in its mirror image. The last cells have 3 / 7 of an edge.
  const auto approach_in_the_corner = [](bool high) {
    auto points = cube(0, 1.5f, 0.1f);
    if (high) {
      for (Vec4& x : points) x = {4 - x.x, 4 - x.y, 4 - x.z, x.w};
    }
    Water water(points, true, [](Vec3 x) { return Vec3{4 * x.z, 0, -4 * x.x}; });
    water.state.foam.cells.lay(water.state.domain, 0.35f, water.state.finest_support);
    water.births();
    const auto x = water.state.particles.all().position.to_host();
    const auto approach = water.state.foam.approach.to_host();
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 from_corner = high ? Vec3{4, 4, 4} - xyz(x[i]) : xyz(x[i]);
      if (!(std::max({from_corner.x, from_corner.y, from_corner.z}) < 0.3f)) continue;
      sum += static_cast<double>(approach[i]);
      ++count;
    }
    return sum / count;
  };
  const double low = approach_in_the_corner(false);
  EXPECT_NEAR(low, pi, 0.15);
  EXPECT_NEAR(approach_in_the_corner(true), low, 0.01 * low);
}

SIM_TEST(Foam, ItsCellsAreNotTooManyInAnyTank) {
  for (const Vec3 size : {Vec3{40, 40, 40}, Vec3{4000, 4000, 0.01f}, Vec3{1e6f, 0.001f, 0.001f}}) {
    const Domain tank{{0, 0, 0}, size};
    MeetingCells cells;
    cells.lay(tank, MeetingCells::edge_of(tank, 0.001f), 0.2f);
    EXPECT_LE(cells.grid.cells(), MeetingCells::most_cells);
    EXPECT_GT(cells.grid.cells(), MeetingCells::most_cells / 2) << "no wider than need be";
  }
  EXPECT_EQ(MeetingCells::edge_of({{0, 0, 0}, {4, 4, 4}}, 0.4f), 0.4f);
}

SIM_TEST(Foam, ParticlesThatShakeAmongEachOtherAreNoWaterThatMeets) {
  const auto shaken = [](Vec3 x) {
    const auto odd = static_cast<int>(std::floor(10 * x.x + 0.25f) + std::floor(10 * x.y + 0.25f));
    return Vec3{odd % 2 ? 1.0f : -1.0f, 0, 0};
  };
  // Neighbours approach at 2 m/s over 0.1 m, but the mean velocities of the cells do not.
  EXPECT_LT(approach_in(shaken, 0.2f), 0.1f);
}

SIM_TEST(Foam, AirIsShutInBetweenWater) {
  // Around a cell in a sheet of two cells, a face, four edges and four corners are dry, with weights 1, 1 / 4
  // and 1 / 9. A lone drop approaches no other water.
  const Speed turns = [](Vec3 x) { return Vec3{4 * x.z, 0, -4 * x.x}; };
  auto points = cube(1, 3, 0.2f);
  std::erase_if(points, [](const Vec4& x) { return x.y < 1.6f || x.y > 2.4f; });
  points.push_back({3.5f, 3.5f, 3.5f, 0.2f});
  Water water(points, true, turns);
  water.births();
  const auto x = water.state.particles.all().position.to_host();
  const auto approach = water.state.foam.approach.to_host();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].x > 3.4f) {
      EXPECT_EQ(approach[i], 0);
    } else if (length(xyz(x[i]) - Vec3{2, 2, 2}) < 0.2f) {
      EXPECT_NEAR(approach[i], (1 - (2 + 4 / 9.0f) / (9 + 8 / 9.0f)) * pi, 0.12f);
    }
  }
}

/// Volume of the births over rate, time step and the water's volume.
double emitted_share(const std::vector<int>& births, const Water& water, double volume) {
  const double all = std::accumulate(births.begin(), births.end(), 0.0);
  return all * static_cast<double>(water.rules.volume / (water.rules.rate * water.rules.dt)) / volume;
}

SIM_TEST(Foam, TheVolumeAtFullPotentialIsTheRateForFineAndForCoarseWater) {
  for (const float h : {0.2f, 0.4f}) {
    Water water(cube(1, 2, h), true, [](Vec3 x) { return Vec3{5, 0, 3 * (x.x - 1.5f)}; });
    water.rules.approach = {0, 1e-6f};
    EXPECT_NEAR(emitted_share(water.births(), water, 1), 1, 0.02) << h;
    // A ramp this wide makes the potential small. The emitted volume over the rate must then be equal for the
    // rate and for twice the rate.
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
  // Foam forms at a block's leading edges and corners, not at its back or in the middle of its faces.
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

SIM_TEST(Foam, WhatIsNotFiniteLeaves) {
  Water water({{1, 1, 1, 0.2f}}, true, [](Vec3) { return Vec3{}; });
  put(water, {3, 3, 3, 1}, {NAN, 0, 0});
  water.move();
  EXPECT_EQ(water.alive(), 0u);
  EXPECT_EQ(water.ledger().left, 1u);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
