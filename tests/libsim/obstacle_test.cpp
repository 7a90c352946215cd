/// Obstacles that a scene lists: their tables, and the water that they displace and push.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

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

TEST(Obstacles, ThinOnesAreRefused) {
  auto scene = pool();
  scene.obstacles[0].size_m[0] = 0.05;
  EXPECT_THROW(sim::make_simulation(scene, options_of()), base::Error);
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
