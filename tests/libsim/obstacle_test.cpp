/// Obstacles that a scene lists: their tables, and the water that they displace and push.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "libsim/scene/extent.hpp"
#include "stats/base/error.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

namespace {

using namespace obstacle_test;
using testing::AllOf;
using testing::HasSubstr;

/// A tank with a box in its middle.
sim::Scene pool(ObstacleMotion motion = ObstacleMotion::Fixed) {
  auto scene = fluid_test::tank({1, 1.5, 1}, {1, 0.75, 1}, 10);
  scene.v_ref_m_s = 2;
  Obstacle post = box({0.5, 0.3, 0.5}, {0.3, 0.5, 0.3});
  post.motion = motion;
  post.way_m = {0.1, 0, 0};
  post.period_s = 1;
  scene.obstacles = {post};
  return scene;
}

TEST(Obstacles, AreReadFromASceneFile) {
  const std::string turning =
      "shape = \"box\"\ncentre_m = [3.0, 1.0, 2.0]\nsize_m = [1.0, 0.4, 0.2]\nrotation_axis = [0.0, 2.0, "
      "0.0]\n"
      "rotation_deg = 90.0\nmotion = \"turns\"\nabout_m = [2.5, 0.0, 2.0]\naxis = [0.0, 1.0, 0.0]\n"
      "rate_rad_s = 1.0\n";
  const auto scene = sim::parse_scene(dam_with(sphere_table + "[[obstacle]]\n" + turning), "scene.toml");
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].radius_m, 0.5);
  EXPECT_EQ(scene.obstacles[1].motion, ObstacleMotion::Turns);
  EXPECT_NEAR(scene.obstacles[1].start.turn[1], std::sqrt(0.5), 1e-12);
  // After a turn by 90 degrees its long side lies along z.
  EXPECT_NEAR(sim::signed_distance(scene.obstacles[1], scene.obstacles[1].start, {3, 1, 2.6}), 0.1, 1e-12);
  const sim::Pose half = sim::pose_at(scene.obstacles[1], 3.14159265358979);
  EXPECT_NEAR(half.centre_m[0], 2, 1e-9);
}

TEST(Obstacles, ErrorsNameThePlaceAndTheMend) {
  const auto error = [](const std::string& text) { return fluid_test::scene_error(dam_with(text)); };
  EXPECT_THAT(fluid_test::scene_error(dam_with(sphere_table, "1")),
              AllOf(HasSubstr("scene.toml:3:"), HasSubstr("came with format 2")));
  EXPECT_THAT(error(changed(sphere_table, "0.5", "0.0")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("radius_m")));
  EXPECT_THAT(error(changed(sphere_table, "0.5", "-1.0")), HasSubstr("radius_m"));
  EXPECT_THAT(error(sphere_table + "motion = \"swings\"\nway_m = [0.5, 0.0, 0.0]\nperiod_s = 0.01\n"),
              AllOf(HasSubstr("motion"), HasSubstr("is faster than time.v_ref_m_s")));
  EXPECT_THAT(error(changed(sphere_table, "1.0, 2.0", "0.4, 2.0")),
              AllOf(HasSubstr("centre_m"), HasSubstr("outside the tank")));
  EXPECT_THAT(error(changed(sphere_table, "sphere", "torus")), HasSubstr("capsule"));
  EXPECT_THAT(error(sphere_table + "motion = \"swings\"\nway_m = [0.0, 0.8, 0.0]\nperiod_s = 1.0\n"),
              HasSubstr("out of the tank"));
  EXPECT_THAT(error(sphere_table + "rotation_deg = 20.0\nrotation_axis = [0.0, 0.0, 0.0]\n"),
              HasSubstr("has no direction"));
}

/// A plate of 0.99 m by 0.99 m that swings over the water of a tank of 1 m by 1 m.
sim::Scene press() {
  auto scene = fluid_test::tank({1, 2.2, 1}, {1, 0.8, 1}, 60);
  scene.v_ref_m_s = 2;
  Obstacle plate = box({0.5, 1.2, 0.5}, {0.99, 0.3, 0.99});
  plate.motion = ObstacleMotion::Swings;
  plate.way_m = {0, -0.5, 0};
  plate.period_s = 4;
  scene.obstacles = {plate};
  return scene;
}

std::string way_error(const sim::Scene& scene, std::int64_t n_star = 4096) {
  try {
    sim::check_ways(scene, n_star);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

// At n_* = 4,096 the finest spacing is cbrt(0.8 / 32768) = 0.0290 m. A gap of 0.005 m is 0.0240 m narrower,
// so that the plate must be narrower by twice that. At its lowest the plate's underside is 0.55 m high; a way
// shorter by 0.25 m ends on the water.
TEST(Obstacles, AWayThatLeavesTheWaterNoRoomIsRefusedForEveryMethodWithMends) {
  for (const auto& traits : sim::all_methods()) {
    sim::SimulationOptions options;
    options.method = traits.kind;
    options.n_star = 4096;
    EXPECT_THAT([&] { sim::make_simulation(press(), options); },
                testing::ThrowsMessage<base::Error>(
                    AllOf(HasSubstr("n_* 4096, obstacle 1 (box)"), HasSubstr("0.55 m3 have room"),
                          HasSubstr("0.8 m3 of water"), HasSubstr("mend: make it narrower by 0.0481 m"),
                          HasSubstr("shorten way_m to a length of 0.25 m"))));
  }
  auto narrower = press();
  narrower.obstacles[0].size_m[2] -= 0.0481;
  EXPECT_EQ(way_error(narrower), "");
  auto shorter = press();
  shorter.obstacles[0].way_m[1] = -0.25;
  EXPECT_EQ(way_error(shorter), "");
}

/// A tank of 1.6 x 1 x 1 m with a lid and a plate that swings along `axis` between two blocks of water.
sim::Scene closed_press(std::size_t axis) {
  sim::Vec3d size{1, 1, 1}, plate{0.99, 0.99, 0.99}, way{};
  size[axis] = 1.6;
  plate[axis] = 0.2;
  way[axis] = 0.6;
  auto scene = fluid_test::tank(size, size, 0);
  scene.lid = true;
  scene.gate = false;
  scene.v_ref_m_s = 2;
  scene.water = {scene.water.front(), scene.water.front()};
  scene.water[0].max_m[axis] = 0.6;
  scene.water[1].min_m[axis] = 1.0;
  scene.obstacles = {box({size[0] / 2, size[1] / 2, size[2] / 2}, plate)};
  scene.obstacles[0].motion = ObstacleMotion::Swings;
  scene.obstacles[0].way_m = way;
  scene.obstacles[0].period_s = 4;
  return scene;
}

TEST(Obstacles, APressIsRefusedAlongAnyAxisOfATankWithALid) {
  // In front of the floor, or of the wall at x or z = 0, 0.1 m3 have room where 0.6 m3 of water are.
  EXPECT_THAT(way_error(closed_press(1)),
              AllOf(HasSubstr("swings down"), HasSubstr("0.1 m3 have room below")));
  for (const std::size_t axis : {0u, 2u}) {
    const std::string wall = axis == 0 ? "x_low" : "z_low";
    EXPECT_THAT(way_error(closed_press(axis)),
                AllOf(HasSubstr("towards the wall " + wall), HasSubstr("0.1 m3 have room between them"),
                      HasSubstr("0.6 m3 of water"), HasSubstr("shorten way_m to a length of 0.0999 m")));
  }
  for (const std::size_t axis : {0u, 1u, 2u}) {
    auto one_side = closed_press(axis);
    one_side.water.erase(one_side.water.begin());
    const char* const walls[] = {"x_high", "y_high", "z_high"};
    EXPECT_THAT(way_error(one_side), HasSubstr(walls[axis]));
    auto short_way = closed_press(axis);
    short_way.obstacles[0].way_m[axis] = 0.01;
    EXPECT_EQ(way_error(short_way), "");
    auto narrow = closed_press(axis);
    for (std::size_t k = 0; k < 3; ++k)
      if (k != axis) narrow.obstacles[0].size_m[k] = 0.9;
    EXPECT_EQ(way_error(narrow), "");
    auto open = closed_press(axis);
    const auto low = static_cast<sim::Wall>(axis == 1 ? 4 : axis),
               high = static_cast<sim::Wall>(axis == 1 ? 5 : axis + 1);
    open.outlets = {{low, {0.1, 0.1}, {0.5, 0.5}}, {high, {0.1, 0.1}, {0.5, 0.5}}};
    EXPECT_EQ(way_error(open), "");
    auto without_lid = closed_press(axis);
    without_lid.lid = false;
    EXPECT_EQ(way_error(without_lid) == "", axis != 1);
  }
}

TEST(Obstacles, AllWaterInsideObstaclesIsRefused) {
  auto scene = fluid_test::tank({1.3, 1.1, 0.9}, {1.3, 0.5, 0.9}, 0);
  scene.obstacles = {box({0.65, 0.3, 0.45}, {1.3, 0.6, 0.9})};
  sim::SimulationOptions options;
  options.n_star = 64;
  EXPECT_THAT([&] { sim::make_simulation(scene, options); },
              testing::ThrowsMessage<base::Error>(HasSubstr("leaves no water")));
  scene.obstacles[0].size_m[0] = 1.0;
  EXPECT_GT(sim::make_simulation(scene, options)->particle_count(), 0);
}

TEST(Obstacles, APressIsRefusedUpwardsFirstTiltedUnderWaterAndAsAMesh) {
  auto upwards = press();
  upwards.obstacles[0].way_m[1] = 0.5;
  EXPECT_NE(way_error(upwards), "");
  auto tilted = press();
  tilted.obstacles[0].start.turn = {0, 0, std::sin(0.05), std::cos(0.05)};  // by 0.1 rad about z
  EXPECT_NE(way_error(tilted), "");
  auto sunk = press();
  sunk.obstacles[0].start.centre_m[1] = 0.6;
  sunk.obstacles[0].way_m[1] = 0.2;
  EXPECT_THAT(way_error(sunk), HasSubstr("let it start above the water"));
  auto mesh_press = press();
  mesh_press.obstacles[0].shape = ObstacleShape::Mesh;
  mesh_press.obstacles[0].mesh = mesh_of(mesh_test::box_text({0, 0, 0}, {0.99, 0.3, 0.99}));
  EXPECT_THAT(way_error(mesh_press), HasSubstr("obstacle 1 (mesh)"));
}

TEST(Obstacles, WaysThatWaterCanFollowAreTaken) {
  const auto taken = [](const auto& change) {
    auto scene = press();
    change(scene, scene.obstacles[0]);
    return way_error(scene);
  };
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.size_m[0] = o.size_m[2] = 0.8; }), "") << "a stamp";
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.size_m[0] = 0.9; }), "") << "a gap at two walls";
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.size_m[0] = 0.95, o.start.centre_m[0] = 0.478; }), "")
      << "a gap at one wall";
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.way_m = {0, -0.24, 0}; }), "") << "it stops above the water";
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.way_m = {0.004, 0, 0}; }), "") << "sideways";
  EXPECT_EQ(taken([](auto&, Obstacle& o) {
              o.size_m = {0.3, 1.6, 0.99};
              o.start.centre_m = {0.2, 0.81, 0.5};
              o.way_m = {0.05, 0, 0};
            }),
            "")
      << "a wave maker";
  EXPECT_EQ(taken([](auto&, Obstacle& o) {
              o.motion = ObstacleMotion::Turns;
              o.about_m = o.start.centre_m;
            }),
            "")
      << "a paddle";
  EXPECT_EQ(taken([](auto&, Obstacle& o) { o.motion = ObstacleMotion::Free; }), "") << "a lid that floats";
  EXPECT_EQ(taken([](auto& scene, auto&) {
              scene.outlets = {{.min_m = {0.4, 0.4}, .max_m = {0.6, 0.6}}};
            }),
            "")
      << "an outlet in the floor";
  EXPECT_EQ(taken([](auto& scene, auto&) { scene.water.front().max_m[0] = 0.5; }), "") << "half of the water";
  EXPECT_EQ(taken([](auto&, Obstacle& o) {
              o.shape = ObstacleShape::Sphere;
              o.radius_m = 0.495;
            }),
            "")
      << "a ball: water passes at the corners";
  EXPECT_EQ(way_error(press(), 1 << 20), "") << "gaps wider than particles";
  EXPECT_NE(taken([](auto& scene, auto&) {
              scene.outlets = {{.wall = sim::Wall::LowX, .min_m = {1.4, 0.4}, .max_m = {1.6, 0.6}}};
            }),
            "")
      << "an outlet above the plate lets none of the water below it out";
}

// A grate: four bars of a mesh round a hole.
TEST(Obstacles, AMeshWithAHoleThatWaterPassesIsNoPress) {
  auto scene = press();
  const auto ring = [](double hole) {
    std::string text;
    for (const double y : {0.0, 0.3})
      for (const double half : {0.495, hole / 2})
        for (const auto& [x, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
          text += "v " + std::to_string(x * half) + " " + std::to_string(y) + " " + std::to_string(z * half) +
                  "\n";
    // Vertices 1-4: outer, below; 5-8: inner, below; 9-12 and 13-16: above.
    for (int k = 0; k < 4; ++k) {
      const int n = (k + 1) % 4;
      const auto face = [&](int a, int b, int c, int d) {
        text += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
                std::to_string(d) + "\n";
      };
      face(1 + k, 1 + n, 5 + n, 5 + k);
      face(9 + n, 9 + k, 13 + k, 13 + n);
      face(1 + n, 1 + k, 9 + k, 9 + n);
      face(5 + k, 5 + n, 13 + n, 13 + k);
    }
    return text;
  };
  scene.obstacles[0].shape = ObstacleShape::Mesh;
  scene.obstacles[0].mesh = mesh_of(ring(0.06));
  EXPECT_EQ(way_error(scene), "");
  scene.obstacles[0].mesh = mesh_of(ring(0.01));
  EXPECT_NE(way_error(scene), "");
}

std::string making_error(const sim::Scene& scene, const sim::SimulationOptions& options) {
  try {
    sim::make_simulation(scene, options);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

TEST(Obstacles, AreAsThickAsTheCoarsestParticlesThatTheRunMayHoldAreApart) {
  auto scene = pool();
  const double d = sim::resolution_of(scene, sim::MethodKind::HiRes, options_of().n_star).finest_spacing_m;
  const auto error = [&](double thickness, sim::MethodKind method, int levels = 4) {
    auto options = options_of(method);
    options.levels = levels;
    scene.obstacles[0].size_m[0] = thickness;
    return making_error(scene, options);
  };
  EXPECT_EQ(error(d, sim::MethodKind::HiRes), "");
  EXPECT_EQ(error(1.01 * d, sim::MethodKind::Ours, 1), "") << "all its particles are the finest";
  EXPECT_EQ(error(1.27 * d, sim::MethodKind::Ours, 2), "") << "cbrt(2) = 1.26";
  EXPECT_NE(error(1.25 * d, sim::MethodKind::Ours, 2), "");
  EXPECT_NE(error(0.99 * d, sim::MethodKind::HiRes), "");
  for (const auto& traits : sim::all_methods()) {
    EXPECT_EQ(error(2.01 * d, traits.kind), "") << traits.name;
    if (traits.kind == sim::MethodKind::HiRes) continue;
    EXPECT_THAT(error(1.99 * d, traits.kind),
                AllOf(HasSubstr("obstacle: box"), HasSubstr("pass through obstacles thinner than 0.18"),
                      HasSubstr("or the method HiRes")))
        << traits.name;
  }
}

/// A column breaks and strikes a plate of one spacing across the tank.
TEST(Obstacles, NoWaterPassesAFixedPlateOfOneSpacingUnderHiRes) {
  auto options = options_of();
  options.n_star = 256;
  auto scene = fluid_test::tank({2, 2, 0.4}, {0.5, 1, 0.4}, 0);
  scene.v_ref_m_s = 5;
  const double d = sim::resolution_of(scene, options.method, options.n_star).finest_spacing_m;
  scene.obstacles = {box({1.2, 1, 0.2}, {d, 2, 0.4})};
  const auto fluid = sim::make_simulation(scene, options);
  double fastest = 0;
  for (int frame = 0; frame < 60; ++frame) {
    fluid->step_frame();
    for (const auto& p : fluid->read_state()) {
      ASSERT_LT(static_cast<double>(p.x_m), 1.2) << "frame " << frame << ", particle " << p.id;
      fastest = std::max(fastest, static_cast<double>(p.vx_m_s));
    }
  }
  EXPECT_GT(fastest, 2) << "it struck the plate";
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
}

TEST(Obstacles, WaterInsideIsLeftOutAndStaysOut) {
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    const auto scene = pool(ObstacleMotion::Swings);
    const auto fluid = sim::make_simulation(scene, options_of(method));
    const double displaced = sim::volume_m3(scene.obstacles[0]) / 0.75;
    EXPECT_NEAR(static_cast<double>(fluid->report().mass_units) / 1024, 1 - displaced, 0.02);
    EXPECT_THAT(fluid->explain(), HasSubstr("obstacle: box of (0.3, 0.5, 0.3) m"));
    EXPECT_THAT(fluid->explain(), HasSubstr("an obstacle moves"));
    for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
    const sim::Pose now = sim::pose_at(scene.obstacles[0], fluid->time_s());
    for (const auto& p : fluid->read_state()) {
      const sim::Vec3d at{static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
      EXPECT_GT(sim::signed_distance(scene.obstacles[0], now, at), -0.02 * fluid->spacing_m()) << p.id;
    }
    EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  }
}

/// Water in front of a moving face gets the face's speed along the normal.
TEST(Obstacles, GiveTheWaterTheirVelocity) {
  const auto scene = pool(ObstacleMotion::Swings);
  auto options = options_of();
  options.n_star = 512;
  options.wall_impulse = true;
  const auto fluid = sim::make_simulation(scene, options);
  double unattributed = 0;
  for (int frame = 0; frame < 4; ++frame) {
    fluid->step_frame();
    unattributed = std::max(unattributed, std::abs(fluid->momentum().unattributed[0]));
    EXPECT_GT(fluid->momentum().obstacles.at(0).push[0], 0);
  }
  EXPECT_LT(unattributed, 0.05) << "N s; the obstacle gives some 10";
  const double face = sim::pose_at(scene.obstacles[0], fluid->time_s()).centre_m[0] + 0.15;
  const double speed = 2 * 3.14159265358979 * 0.1 * std::cos(2 * 3.14159265358979 * fluid->time_s());
  double sum = 0;
  int count = 0;
  for (const auto& p : fluid->read_state()) {
    const auto x = static_cast<double>(p.x_m) - face;
    if (x < 0 || x > fluid->spacing_m() || std::abs(p.z_m - 0.5f) > 0.1f || std::abs(p.y_m - 0.25f) > 0.15f)
      continue;
    sum += static_cast<double>(p.vx_m_s);
    ++count;
  }
  ASSERT_GT(count, 4);
  EXPECT_NEAR(sum / count / speed, 1, 0.3)
      << "0.75: the band is a spacing wide, and water flows off sideways";
}

TEST(Obstacles, ASavedRunGoesOnBitForBit) {
  const test::TemporaryFolder folder;
  const auto scene = sim::read_scene(base::resource("data/scenes/mixer.toml"));
  auto options = options_of(sim::MethodKind::Ours);
  options.n_star = 512;
  const auto whole = sim::make_simulation(scene, options);
  // By now the paddle is far from its start.
  for (int frame = 0; frame < 40; ++frame) whole->step_frame();
  whole->save_state(folder.path() / "state");
  options.resume_from = folder.path() / "state";
  const auto rest = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 10; ++frame) {
    whole->step_frame();
    rest->step_frame();
  }
  const auto a = whole->read_state();
  const auto b = rest->read_state();
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
  auto other = scene;
  other.obstacles[0].rate_rad_s = 1;
  EXPECT_THROW(sim::make_simulation(other, options), base::Error) << "a state of another scene";
}

}  // namespace
