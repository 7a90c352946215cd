/// Obstacles that the water moves: their tables, the account of their momentum, walls, saved states.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "libsim/scene/effects.hpp"
#include "stats/base/error.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

namespace {

using namespace obstacle_test;
using testing::AllOf;
using testing::HasSubstr;

Obstacle free_sphere(double density) { return free_one(sphere({0.5, 0.55, 0.5}, 0.25), density); }
sim::Scene pool_with(const Obstacle& obstacle, double depth = 0.75) {
  auto scene = fluid_test::tank({1, 1.5, 1}, {1, depth, 1}, 10);
  scene.v_ref_m_s = 3;
  scene.obstacles = {obstacle};
  return scene;
}
std::string ball_with(const std::string& motion) { return dam_with(sphere_table + motion); }

TEST(FreeObstacles, AreReadFromASceneFile) {
  const auto scene = sim::parse_scene(ball_with("motion = \"free\"\ndensity_kg_m3 = 300.0\n"), "scene.toml");
  EXPECT_EQ(scene.obstacles.at(0).motion, ObstacleMotion::Free);
  EXPECT_EQ(scene.obstacles[0].density_kg_m3, 300);
  EXPECT_TRUE(sim::any_free(scene.obstacles));
  EXPECT_THAT(sim::obstacles_in_words(scene.obstacles), HasSubstr("free, 300 kg/m3"));
  const auto error = [](const std::string& motion) { return fluid_test::scene_error(ball_with(motion)); };
  EXPECT_THAT(error("motion = \"free\"\n"), AllOf(HasSubstr("scene.toml:"), HasSubstr("density_kg_m3")));
  EXPECT_THAT(error("motion = \"free\"\ndensity_kg_m3 = 0.0\n"), HasSubstr("density_kg_m3"));
  EXPECT_THAT(error("density_kg_m3 = 300.0\n"), HasSubstr("density_kg_m3")) << "only free ones have one";
  EXPECT_THAT(error("motion = \"free\"\ndensity_kg_m3 = 300.0\n[central_force]\nomega_per_s = 1.0\n"
                    "centre_m = [1.0, 1.0, 1.0]\naxis = [0.0, 0.0, 1.0]\n"),
              HasSubstr("would not pull it"));
}

TEST(FreeObstacles, MomentsOfInertiaAreThoseOfTheShape) {
  for (const auto shape : {ObstacleShape::Sphere, ObstacleShape::Box, ObstacleShape::Capsule}) {
    Obstacle o;
    o.shape = shape;
    if (shape == ObstacleShape::Box) o.size_m = {0.6, 0.45, 0.9};
    if (shape != ObstacleShape::Box) o.radius_m = 0.3;
    if (shape == ObstacleShape::Capsule) o.length_m = 0.5;
    sim::Vec3d sum{};
    double volume = 0;
    constexpr int n = 80;
    for (int k = 0; k < n * n * n; ++k) {
      const auto at = [](int cell) { return 1.2 * ((cell + 0.5) / n - 0.5); };
      const sim::Vec3d x{at(k % n), at(k / n % n), at(k / (n * n))};
      if (sim::signed_distance(o, {}, x) > 0) continue;
      volume += 1;
      for (std::size_t a = 0; a < 3; ++a)
        sum[a] += x[(a + 1) % 3] * x[(a + 1) % 3] + x[(a + 2) % 3] * x[(a + 2) % 3];
    }
    const auto moments = sim::inertia_m2(o);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(moments[a] / (sum[a] / volume), 1, 0.02) << sim::shape_name(shape) << " " << a;
  }
}

/// A body without contact falls as water does, and the floor stops it.
TEST(FreeObstacles, FallAndComeToRestOnTheFloor) {
  Obstacle brick = free_one(box({1.2, 1.0, 1.2}, {0.4, 0.3, 0.5}), 700);
  brick.start.turn = {0, 0, 0.2588190451, 0.9659258263};  // 30 degrees about z
  const auto scene = dry({brick});
  const auto fluid = sim::make_simulation(scene, options_of());
  double rested_s = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles().at(0);
    // The body is still at rest in the first substep.
    if (frame == 0) rested_s = scene.frame_dt_s / fluid->substeps().taken;
    if (frame < 15) {
      EXPECT_NEAR(now.velocity_m_s[1], -9.81 * (fluid->time_s() - rested_s), 1e-4);
    }
    for (int corner = 0; corner < 8; ++corner) {
      // Points under the brick, 1 mm below the floor, must not be inside it.
      const sim::Vec3d below{now.pose.centre_m[0] + (corner & 1 ? 0.1 : -0.1), -1e-3,
                             now.pose.centre_m[2] + (corner & 4 ? 0.1 : -0.1)};
      EXPECT_GT(sim::signed_distance(brick, now.pose, below), -1e-9) << frame;
    }
  }
  const auto last = fluid->read_obstacles().at(0);
  EXPECT_NEAR(last.pose.centre_m[1], 0.15, 0.01) << "it lies on its broad side";
  EXPECT_NEAR(last.velocity_m_s[1], 0, 1e-3);
  EXPECT_NEAR(last.walls_n_s[1], mass_of(brick) * 9.81 * scene.frame_dt_s, 0.01);
}

/// The body's change of momentum must equal the impulses of the water, of the walls and of its weight.
void momentum_is_the_waters_and_the_walls(const sim::Scene& scene) {
  auto options = options_of();
  options.wall_impulse = true;
  options.substeps = 3;
  const auto fluid = sim::make_simulation(scene, options);
  auto before = fluid->read_obstacles().at(0);
  const double density = scene.obstacles[0].density_kg_m3;
  const double mass = mass_of(scene.obstacles[0]);
  const double displaced = 1000 * sim::volume_m3(scene.obstacles[0]);
  int walls = 0;
  for (int frame = 0; frame < 40; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles().at(0);
    const auto account = fluid->momentum();
    for (std::size_t k = 0; k < 3; ++k) {
      const double gained =
          mass * (now.velocity_m_s[k] - before.velocity_m_s[k]) + now.owed_n_s[k] - before.owed_n_s[k];
      const double weight = k == 1 ? -mass * 9.81 * scene.frame_dt_s : 0;
      EXPECT_NEAR(gained, now.walls_n_s[k] + weight - account.obstacles.at(0).push[k],
                  2e-3 * mass * 9.81 * scene.frame_dt_s + 2e-3)
          << density << " frame " << frame;
      const double counted = account.forces[k] + account.levels[k] + account.braked[k] +
                             account.viscosity[k] + account.effects[k] + account.inherited[k] +
                             account.unattributed[k] + account.walls_sum()[k] +
                             account.obstacles.at(0).push[k];
      EXPECT_NEAR(account.after[k] - account.before[k], counted, 1e-3) << density << " frame " << frame;
    }
    EXPECT_NEAR(account.unattributed[1], 0, 0.01) << "what the water got";
    EXPECT_LT(std::abs(now.owed_n_s[1]), 4 * displaced * 9.81 * scene.frame_dt_s) << "it follows in the end";
    walls += now.walls_n_s[1] != 0;
    before = now;
  }
  const bool honey = !scene.effects.empty() && scene.effects[0].kind == sim::EffectKind::Viscosity;
  EXPECT_EQ(walls > 0, density > 1000 && !honey) << "the heavy one reaches the floor";
}

TEST(FreeObstacles, MomentumIsTheWatersAndTheWalls) {
  for (const double density : {100.0, 500.0, 3000.0})
    momentum_is_the_waters_and_the_walls(pool_with(free_sphere(density)));
}
TEST(FreeObstacles, MomentumIsThatOfEffectsToo) {
  NEEDS_EFFECTS;
  using sim::EffectKind;
  const std::vector<std::vector<sim::Effect>> all{
      {{EffectKind::Viscosity, 5}},
      {{EffectKind::Friction, 1}},
      {{EffectKind::Cohesion, 20}, {EffectKind::Adhesion, 30}},
  };
  for (const auto& effects : all) {
    SCOPED_TRACE(sim::effects_in_words(effects));
    for (const double density : {100.0, 3000.0}) {
      auto scene = pool_with(free_sphere(density));
      scene.viscosity_m2_s = 0;
      scene.effects = effects;
      momentum_is_the_waters_and_the_walls(scene);
    }
  }
}

/// A ball in water whose rotation is set to 1 rad/s before each frame: it must reach 0.8 rad/s within half a
/// second and never exceed 1.05 rad/s.
void water_that_turns_spins_a_ball(const sim::Effect& effect, bool triangles = false) {
  for (const double density : {100.0, 1000.0}) {
    const sim::Vec3d middle{0.5, 0.5, 0.5};
    const Obstacle ball = triangles ? mesh(middle, mesh_test::ball_text(0.25, 24)) : sphere(middle, 0.25);
    auto scene = pool_with(free_one(ball, density), 1);
    scene.gravity_m_s2 = 0;
    scene.viscosity_m2_s = 0;
    scene.effects = {effect};
    const auto fluid = sim::make_simulation(scene, options_of());
    double fastest = 0;
    for (int frame = 0; frame < 30; ++frame) {
      auto state = fluid->read_state();
      for (auto& p : state) {
        p.vx_m_s = p.z_m - 0.5f;
        p.vz_m_s = 0.5f - p.x_m;
      }
      fluid->put(state);
      fluid->step_frame();
      fastest = std::max(fastest, fluid->read_obstacles().at(0).spin_rad_s[1]);
    }
    const auto spin = fluid->read_obstacles().at(0).spin_rad_s;
    EXPECT_GT(spin[1], 0.8) << density;
    EXPECT_LT(fastest, 1.05) << density;
    EXPECT_LT(std::hypot(spin[0], spin[2]), 0.1) << density;
  }
}
TEST(FreeObstacles, HoneyThatTurnsSpinsABall) {
  NEEDS_EFFECTS;
  for (const bool triangles : {false, true})
    water_that_turns_spins_a_ball({sim::EffectKind::Viscosity, 1}, triangles);
}
TEST(FreeObstacles, FrictionOfWaterThatTurnsSpinsABall) {
  NEEDS_EFFECTS;
  for (const double drag : {1.0, 100.0}) water_that_turns_spins_a_ball({sim::EffectKind::Friction, drag});
}

TEST(FreeObstacles, ASavedRunGoesOnBitForBit) {
  const test::TemporaryFolder folder;
  auto scene = pool_with(free_one(box({0.5, 0.55, 0.5}, {0.4, 0.3, 0.5}), 400));
  if (sim::has_effects()) scene.effects = {{sim::EffectKind::Viscosity, 0.1}, {sim::EffectKind::Friction, 1}};
  auto options = options_of(sim::MethodKind::OursTsp);
  options.temporal.fixed_tau = -10;
  const auto whole = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 20; ++frame) whole->step_frame();
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
  const auto at = whole->read_obstacles(), again = rest->read_obstacles();
  EXPECT_EQ(at[0].pose.centre_m, again[0].pose.centre_m);
  EXPECT_EQ(at[0].pose.turn, again[0].pose.turn);
  EXPECT_EQ(at[0].velocity_m_s, again[0].velocity_m_s);
  EXPECT_EQ(at[0].spin_rad_s, again[0].spin_rad_s);
  EXPECT_EQ(at[0].owed_n_s, again[0].owed_n_s);
  EXPECT_EQ(at[0].walls_n_s, again[0].walls_n_s);
  EXPECT_NE(at[0].velocity_m_s[1], 0);
}

/// If all obstacles are fixed, no pass runs that only free obstacles need.
TEST(FreeObstacles, CostNothingWhereNoneIs) {
  auto scene = pool_with(free_sphere(500));
  const auto launches = [](const sim::Scene& of) {
    const auto fluid = sim::make_simulation(of, options_of());
    fluid->profile_launches(true);
    fluid->step_frame();
    std::string out;
    for (const auto& time : fluid->launch_times()) out += std::string(time.label) + "\n";
    fluid->profile_launches(false);
    return out + fluid->explain();
  };
  EXPECT_THAT(launches(scene), AllOf(HasSubstr("move bodies\n"), HasSubstr("gather volume\n"),
                                     HasSubstr("an obstacle is free")));
  scene.obstacles[0].motion = ObstacleMotion::Fixed;
  EXPECT_THAT(launches(scene),
              testing::Not(testing::AnyOf(HasSubstr("move bodies"), HasSubstr("push bodies"),
                                          HasSubstr("clamp and record"), HasSubstr("fastest body"),
                                          HasSubstr("an obstacle is free"))));
  if (!sim::has_effects()) return;
  // Nothing reads the impulse on a fixed obstacle.
  const auto hears = HasSubstr("record bodies");
  scene.effects = {{sim::EffectKind::Viscosity, 1}};
  EXPECT_THAT(launches(scene), AllOf(HasSubstr("viscous pairs\n"), testing::Not(hears)));
  scene.obstacles[0].motion = ObstacleMotion::Free;
  EXPECT_THAT(launches(scene), hears);
}

TEST(FreeObstacles, BeginWithTheRun) {
  const auto scene = pool_with(free_sphere(500));
  auto options = options_of();
  options.start = sim::make_simulation(scene, options)->read_state();
  options.start_frame = 60;
  try {
    sim::make_simulation(scene, options);
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the positions of its free obstacles are not known"));
  }
}

TEST(FreeObstacles, AreCarriedWhereLittleRoomIsLeftBesideThem) {
  // The tank is three cells wide, and less than one cell is between the sphere and each wall.
  const Obstacle ball = free_one(sphere({0.5, 0.55, 0.5}, 0.35), 400);
  const auto fluid = sim::make_simulation(pool_with(ball, 1.1), options_of());
  for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
  EXPECT_GT(fluid->read_obstacles().at(0).pose.centre_m[1], ball.start.centre_m[1] + 0.05);
}

TEST(FreeObstacles, AreCheckedInScenesThatNoFileDescribes) {
  EXPECT_THAT(
      [] { sim::make_simulation(pool_with(free_sphere(0)), options_of()); },
      testing::ThrowsMessage<base::Error>(AllOf(HasSubstr("0 kg/m3"), HasSubstr("50 kg/m3 or more"))));
  auto scene = pool_with(free_sphere(500));
  scene.central_force = sim::CentralForce{};
  EXPECT_THAT([&] { sim::make_simulation(scene, options_of()); },
              testing::ThrowsMessage<base::Error>(HasSubstr("central force")));
}

}  // namespace
