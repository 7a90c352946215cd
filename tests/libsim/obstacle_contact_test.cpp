/// Obstacles in contact with each other in the tank: their tables, the water beside them, the account of
/// their impulses, saved states.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "libsim/scene/overlap.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

namespace {

using namespace obstacle_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

sim::Scene pool(const std::vector<Obstacle>& obstacles) {
  auto scene = fluid_test::tank({1.5, 1.5, 1}, {1.5, 0.6, 1}, 10);
  scene.v_ref_m_s = 3;
  scene.obstacles = obstacles;
  return scene;
}
const std::string free_cube =
    "[[obstacle]]\nshape = \"box\"\ncentre_m = [2.0, 2.0, 2.0]\nsize_m = [0.8, 0.8, 0.8]\n"
    "motion = \"free\"\ndensity_kg_m3 = 500.0\n";
TEST(ObstacleContact, FrictionIsReadFromASceneFile) {
  const auto scene = sim::parse_scene(dam_with(sphere_table + "friction = 0.4\n" + free_cube), "scene.toml");
  EXPECT_EQ(scene.obstacles.at(0).friction, 0.4);
  EXPECT_EQ(scene.obstacles.at(1).friction, 0) << "where none is given";
  EXPECT_THAT(sim::obstacles_in_words(scene.obstacles), HasSubstr(", friction 0.4\n"));
  const auto error = [](const std::string& value) {
    return fluid_test::scene_error(dam_with(sphere_table + "friction = " + value + "\n"));
  };
  EXPECT_THAT(error("-0.1"), AllOf(HasSubstr("scene.toml:"), HasSubstr("friction"), HasSubstr("[0, 10]")));
  EXPECT_THAT(error("11.0"), HasSubstr("friction"));
  EXPECT_THAT(error("nan"), HasSubstr("friction"));
  EXPECT_THAT(error("\"rough\""), HasSubstr("friction"));
}

TEST(ObstacleContact, WhoBeginsInsideAnotherIsRefused) {
  const auto error = [](const std::string& text) { return fluid_test::scene_error(dam_with(text)); };
  EXPECT_EQ(error(sphere_table + free_cube), "no error");
  const auto text = sphere_table + changed(free_cube, "2.0, 2.0, 2.0", "2.0, 1.7, 2.0");
  EXPECT_THAT(error(text),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("centre_m"), HasSubstr("0.2 m deep"),
                    HasSubstr("obstacle 1 of the file"), HasSubstr("must start outside the others")));
  EXPECT_EQ(error(sphere_table + changed(free_cube, "2.0, 2.0, 2.0", "2.0, 1.9, 2.0")), "no error")
      << "who touches is not inside";
  EXPECT_EQ(error(changed(changed(text, "motion = \"free\"\n", ""), "density_kg_m3 = 500.0\n", "")),
            "no error")
      << "fixed ones may make up one shape";
}

TEST(ObstacleContact, OverlapsAreSeenWhateverLiesInWhat) {
  const Obstacle cube = box({0, 0, 0}, {1, 1, 1});
  EXPECT_NEAR(sim::overlap_m(cube, sphere({0, 0.7, 0}, 0.3)), 0.1, 1e-9);
  EXPECT_GT(sim::overlap_m(cube, sphere({0.1, 0, 0}, 0.1)), 0.1) << "all of it";
  EXPECT_NEAR(sim::overlap_m(cube, box({0.95, 0, 0}, {1, 0.5, 0.5})), 0.05, 1e-9);
  EXPECT_LT(sim::overlap_m(cube, box({1.05, 0, 0}, {1, 0.5, 0.5})), 0);
  // Neither box has a corner or its centre inside the other.
  EXPECT_NEAR(sim::overlap_m(box({0, 0, 0}, {2, 0.2, 0.2}), box({0.5, 0.15, 0}, {0.2, 0.2, 2})), 0.05, 1e-6);
  EXPECT_GT(sim::overlap_m(cube, mesh({0.6, 0.6, 0}, mesh_test::ball_text(0.3, 24))), 0.1);
}

TEST(ObstacleContact, ABallFallsOntoABoxAndRests) {
  for (const bool triangles : {true, false}) {
    const Obstacle table = box({1.3, 0.4, 1.3}, {0.8, 0.4, 0.8});
    const Obstacle ball =
        triangles ? mesh({1.3, 1.2, 1.3}, mesh_test::ball_text(0.2, 24)) : sphere({1.3, 1.2, 1.3}, 0.2);
    const auto fluid = sim::make_simulation(dry({table, free_one(ball, 700)}), options_of());
    for (int frame = 0; frame < 60; ++frame) {
      fluid->step_frame();
      EXPECT_GT(fluid->read_obstacles().at(1).pose.centre_m[1], 0.8 - 2e-3) << frame;
    }
    const auto last = fluid->read_obstacles();
    EXPECT_NEAR(last[1].pose.centre_m[1], 0.8, 2e-3);
    EXPECT_NEAR(last[1].velocity_m_s[1], 0, 1e-2);
    const double weight = 700 * sim::volume_m3(ball) * 9.81 / 60;
    EXPECT_NEAR(last[1].others_n_s[1], weight, 0.02 * weight);
    EXPECT_NEAR(last[0].others_n_s[1], -weight, 0.02 * weight);
    EXPECT_EQ(last[1].walls_n_s[1], 0);
  }
}

TEST(ObstacleContact, ACubeOfTrianglesRestsOnAnother) {
  const auto lower = mesh_test::box_text({-0.2, -0.15, -0.2}, {0.2, 0.15, 0.2});
  const auto upper = mesh_test::box_text({-0.15, -0.15, -0.15}, {0.15, 0.15, 0.15});
  const auto fluid = sim::make_simulation(
      dry({free_one(mesh({1.3, 0.15, 1.3}, lower), 800), free_one(mesh({1.32, 0.6, 1.29}, upper), 400)}),
      options_of());
  for (int frame = 0; frame < 90; ++frame) fluid->step_frame();
  EXPECT_NEAR(fluid->read_obstacles().at(0).pose.centre_m[1], 0.15, 2e-3);
  EXPECT_NEAR(fluid->read_obstacles().at(1).pose.centre_m[1], 0.45, 0.01);
}

/// A body's change of momentum must equal the impulses of the water, the walls, the other bodies and its
/// weight.
TEST(ObstacleContact, TenBallsInAPoolKeepApartAndKeepTheAccount) {
  std::vector<Obstacle> balls;
  for (int k = 0; k < 10; ++k) {
    const double at = k;
    balls.push_back(free_one(
        sphere({0.3 + 0.45 * (k % 3) + 0.01 * at, 0.75 + 0.16 * at / 3, 0.3 + 0.4 * (k / 3 % 2)}, 0.12),
        k % 2 ? 300 : 2500));
  }
  auto options = options_of();
  options.wall_impulse = true;
  options.substeps = 3;
  const auto scene = pool(balls);
  const auto fluid = sim::make_simulation(scene, options);
  const auto energy = [&] {
    double out = 0;
    for (const auto& p : fluid->read_state()) {
      const double m = 1000 * std::pow(fluid->spacing_m(), 3);
      const double v = std::hypot(static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                                  static_cast<double>(p.vz_m_s));
      out += m * (v * v / 2 + 9.81 * static_cast<double>(p.y_m));
    }
    const auto bodies = fluid->read_obstacles();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto& v = bodies[b].velocity_m_s;
      out += mass_of(balls[b]) *
             ((v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + 9.81 * bodies[b].pose.centre_m[1]);
    }
    return out;
  };
  const double began = energy();
  auto before = fluid->read_obstacles();
  double met = 0, deepest = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles();
    const auto account = fluid->momentum();
    sim::Vec3d others{};
    for (std::size_t b = 0; b < balls.size(); ++b) {
      const double mass = mass_of(balls[b]);
      const auto& at = now[b].pose.centre_m;
      for (std::size_t k = 0; k < 3; ++k) {
        const double gained = mass * (now[b].velocity_m_s[k] - before[b].velocity_m_s[k]) +
                              now[b].owed_n_s[k] - before[b].owed_n_s[k];
        const double weight = k == 1 ? -mass * 9.81 * scene.frame_dt_s : 0;
        EXPECT_NEAR(gained,
                    now[b].walls_n_s[k] + now[b].others_n_s[k] + weight - account.obstacles.at(b).push[k],
                    2e-3 * mass * 9.81 * scene.frame_dt_s + 2e-3)
            << b << " frame " << frame;
        others[k] += now[b].others_n_s[k];
        met = std::max(met, std::abs(now[b].others_n_s[k]));
        EXPECT_GT(at[k], 0.12 - 1e-4) << b << " frame " << frame;
        if (k != 1) {
          EXPECT_LT(at[k], scene.tank_size_m[k] - 0.12 + 1e-4) << b << " frame " << frame;
        }
      }
      for (std::size_t c = 0; c < b; ++c) {
        const auto& other = now[c].pose.centre_m;
        deepest = std::max(deepest, 0.24 - std::hypot(at[0] - other[0], at[1] - other[1], at[2] - other[2]));
      }
    }
    for (const double sum : others) EXPECT_NEAR(sum, 0, 1e-4);
    before = now;
  }
  EXPECT_GT(met, 0.5) << "they met";
  EXPECT_LT(deepest, 0.01 * 0.12) << "a hundredth of the radius";
  EXPECT_LT(energy(), began);
  EXPECT_EQ(fluid_test::outside(fluid->read_state(), scene.tank_size_m, 1e-4), 0);
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
}

TEST(ObstacleContact, APaddlePushesWhatFloats) {
  Obstacle paddle = box({0.25, 0.6, 0.5}, {0.2, 0.5, 0.8});
  paddle.motion = ObstacleMotion::Swings;
  paddle.way_m = {0.12, 0, 0};
  paddle.period_s = 1;
  const Obstacle ball = free_one(sphere({0.6, 0.6, 0.5}, 0.15), 400);
  const auto scene = pool({paddle, ball});
  const auto fluid = sim::make_simulation(scene, options_of());
  double pushed = 0;
  for (int frame = 0; frame < 90; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles();
    EXPECT_GT(sim::signed_distance(paddle, now[0].pose, now[1].pose.centre_m), 0.15 * 0.99) << frame;
    pushed += now[1].others_n_s[0];
    EXPECT_EQ(now[1].others_n_s[0], -now[0].others_n_s[0]);
  }
  EXPECT_GE(pushed, 0);
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
}

TEST(ObstacleContact, ABallAfloatStaysOutOfAPost) {
  // The post rises above the water. The gate opens, and the water carries the ball to the post.
  const Obstacle post = box({1.0, 0.5, 0.5}, {0.3, 1.0, 0.3});
  auto scene = pool({post, free_one(sphere({0.62, 0.62, 0.5}, 0.15), 400)});
  scene.water.front().max_m = {0.7, 0.9, 1};
  scene.gate = true;
  scene.obstacles[1].start.centre_m = {0.5, 1.1, 0.5};
  const auto fluid = sim::make_simulation(scene, options_of());
  double met = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles();
    EXPECT_GT(sim::signed_distance(post, now[0].pose, now[1].pose.centre_m), 0.15 * 0.99) << frame;
    met = std::min(met, now[1].others_n_s[0]);
  }
  EXPECT_LT(met, 0) << "the water carries it against the post";
}

TEST(ObstacleContact, FrictionOfOneAloneIsTheWalls) {
  for (const double friction : {0.0, 0.3}) {
    Obstacle brick = free_one(box({1.3, 0.1, 1.3}, {0.4, 0.2, 0.4}), 700);
    brick.start.turn = {0, 0, std::sin(0.1), std::cos(0.1)};
    brick.start.centre_m[1] = 0.3;
    brick.friction = friction;
    const auto fluid = sim::make_simulation(dry({brick}), options_of());
    EXPECT_THAT(fluid->explain(), friction > 0
                                      ? HasSubstr("a free obstacle may meet another, or has friction")
                                      : HasSubstr("an obstacle is free"));
    double walls = 0;
    for (int frame = 0; frame < 60; ++frame) {
      fluid->step_frame();
      walls = std::max(walls, std::abs(fluid->read_obstacles().at(0).walls_n_s[0]));
    }
    EXPECT_EQ(walls > 0, friction > 0) << "the floor has no other way to push it aside";
    EXPECT_NEAR(fluid->read_obstacles().at(0).pose.centre_m[1], 0.1, 1e-3);
  }
}

TEST(ObstacleContact, CostsNothingWhereNoneMayMeet) {
  const auto launches = [](const std::vector<Obstacle>& obstacles) {
    const auto fluid = sim::make_simulation(dry(obstacles), options_of());
    fluid->profile_launches(true);
    fluid->step_frame();
    std::string out;
    for (const auto& time : fluid->launch_times()) out += std::string(time.label) + "\n";
    fluid->profile_launches(false);
    return out;
  };
  const Obstacle one = sphere({1.3, 1, 1.3}, 0.2), other = sphere({1.3, 0.3, 1.3}, 0.2);
  EXPECT_THAT(launches({one, other}),
              Not(testing::AnyOf(HasSubstr("meet bodies"), HasSubstr("move bodies"))));
  EXPECT_THAT(launches({free_one(one, 500)}), AllOf(HasSubstr("move bodies\n"), Not(HasSubstr("meet"))));
  EXPECT_THAT(launches({free_one(one, 500), other}),
              AllOf(HasSubstr("meet bodies\n"), Not(HasSubstr("move"))));
}

std::vector<Obstacle> two_that_meet() {
  std::vector<Obstacle> out{free_one(box({0.7, 1.1, 0.5}, {0.4, 0.3, 0.5}), 700),
                            free_one(sphere({0.75, 0.75, 0.5}, 0.18), 300),
                            box({0.2, 0.2, 0.5}, {0.3, 0.4, 0.9})};
  for (Obstacle& o : out) o.friction = 0.3;
  return out;
}

TEST(ObstacleContact, ASavedRunGoesOnBitForBit) {
  const test::TemporaryFolder folder;
  const auto scene = pool(two_that_meet());
  auto options = options_of(sim::MethodKind::OursTsp);
  options.temporal.fixed_tau = -10;
  const auto whole = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 20; ++frame) whole->step_frame();
  EXPECT_NE(whole->read_obstacles().at(0).others_n_s[1], 0);
  whole->save_state(folder.path() / "state");
  options.resume_from = folder.path() / "state";
  const auto rest = sim::make_simulation(scene, options);
  const auto same = [&] {
    const auto a = whole->read_obstacles(), b = rest->read_obstacles();
    return std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
  };
  EXPECT_TRUE(same());
  for (int frame = 0; frame < 10; ++frame) {
    whole->step_frame();
    rest->step_frame();
    EXPECT_TRUE(same()) << frame;
  }
}

TEST(ObstacleContact, ThreadsChangeNoBit) {
  const int usual = omp_get_max_threads();
  const auto run = [&](int threads) {
    omp_set_num_threads(threads);
    const auto fluid = sim::make_simulation(pool(two_that_meet()), options_of());
    for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
    return fluid->read_obstacles();
  };
  const auto one = run(1), three = run(3);
  omp_set_num_threads(usual);
  EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof one[0]), 0);
}

/// A body of 20,000 kg/m3 on one of 50 kg/m3, in water and between walls.
TEST(ObstacleContact, TheHeaviestLiesOnTheLightest) {
  const auto scene = pool({free_one(box({0.75, 0.2, 0.5}, {0.5, 0.4, 0.5}), 50),
                           free_one(box({0.75, 0.65, 0.5}, {0.4, 0.4, 0.4}), 20000)});
  const auto fluid = sim::make_simulation(scene, options_of());
  for (int frame = 0; frame < 90; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles();
    for (const auto& body : now) {
      ASSERT_TRUE(std::isfinite(body.pose.centre_m[0] + body.pose.centre_m[1] + body.pose.centre_m[2]));
      ASSERT_LT(std::hypot(body.velocity_m_s[0], body.velocity_m_s[1], body.velocity_m_s[2]), 5) << frame;
    }
  }
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  EXPECT_GT(fluid->read_obstacles().at(1).pose.centre_m[1], 0.59)
      << "it lies on the light one, which holds it";
}

/// Water between two closing faces can escape only sideways.
TEST(ObstacleContact, LittleWaterIsCaughtBetweenFaces) {
  const auto scene = pool({free_one(box({0.75, 0.16, 0.5}, {0.4, 0.3, 0.4}), 3000),
                           free_one(box({0.75, 0.85, 0.5}, {0.4, 0.3, 0.4}), 4000)});
  const auto fluid = sim::make_simulation(scene, options_of());
  int most = 0;
  double deepest_m = 0, leap_m_s = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles();
    int inside = 0;
    for (const auto& p : fluid->read_state()) {
      const sim::Vec3d at{static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
      for (std::size_t b = 0; b < now.size(); ++b) {
        const double depth = -sim::signed_distance(scene.obstacles[b], now[b].pose, at);
        inside += depth > 0.02 * fluid->spacing_m();
        deepest_m = std::max(deepest_m, depth);
      }
    }
    most = std::max(most, inside);
    leap_m_s = std::max(leap_m_s, now[1].velocity_m_s[1]);
  }
  // Measured: 4 of 976 particles inside bodies, at most 0.13 d deep; the upper body leaps at 0.5 m/s.
  EXPECT_LE(most, 10);
  EXPECT_LT(deepest_m, 0.25 * fluid->spacing_m());
  EXPECT_LT(leap_m_s, 1);
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
}

}  // namespace
