/// Foam and obstacles: collisions, surfaces and enclosed air beside obstacles, and births.

#include "tests/libsim/backend/foam_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

using namespace foam_crowds;

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
  // A foam particle that the body has moved over.
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
  // The water has no surface at the obstacle either.
  const auto normal_beside = [&](const auto& bounds) {
    water.find_surface(bounds);
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

SIM_TEST(Foam, AirIsShutInBesideObstaclesToo) {
  auto points = cube(0.8f, 3.2f, 0.2f);
  Body box = body(false);
  box.half = {0.4f, 0.4f, 0.4f};
  std::erase_if(points, [&](const Vec4& x) { return box.distance(xyz(x)) < 0; });
  Water water(points, true, [](Vec3 x) { return Vec3{4 * x.z, 0, -4 * x.x}; });
  const Solids solids = with_body(water, box);
  water.rules.energy = {-1, 1e-6f};
  const auto approach_beside = [&](const auto& bounds) {
    water.find_surface(bounds);
    const auto x = water.state.particles.all().position.to_host();
    const auto approach = water.state.foam.approach.to_host();
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (length(xyz(x[i]) - Vec3{2.55f, 2, 2}) < length(xyz(x[nearest]) - Vec3{2.55f, 2, 2})) nearest = i;
    }
    return approach[nearest];
  };
  EXPECT_LT(approach_beside(water.state.walls), 0.9f * pi) << "to who knows of no obstacle";
  EXPECT_NEAR(approach_beside(solids), pi, 0.15f);
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

}  // namespace
}  // namespace sim::SIM_BACKEND
