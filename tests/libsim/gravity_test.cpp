/// Gravity along any direction, and tanks with a lid. A scene turned with its gravity must behave as the
/// scene that stands upright.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;
using sim::MethodKind;
using sim::Vec3d;
using sim::Wall;

constexpr double d = 0.15;
constexpr double g = 9.81;

/// A rotation by quarter turns, maybe with a mirror image.
struct Turn {
  const char* name;
  std::array<std::size_t, 3> from;  ///< axis of the upright scene that becomes this axis
  std::array<bool, 3> mirrored;     ///< whether its direction is reversed
};
constexpr Turn upright{"upright", {0, 1, 2}, {false, false, false}};
constexpr Turn on_its_right{"gravity along +x", {1, 0, 2}, {true, false, false}};
constexpr Turn on_its_left{"gravity along -x", {1, 0, 2}, {false, true, false}};
constexpr Turn on_its_back{"gravity along +z", {0, 2, 1}, {false, false, true}};
constexpr Turn upside_down{"gravity along +y", {0, 1, 2}, {true, true, false}};
constexpr Turn turns[] = {on_its_right, on_its_left, on_its_back, upside_down};

Vec3d turned(const Turn& turn, const Vec3d& at, const Vec3d& size) {
  Vec3d out;
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = turn.mirrored[k] ? size[turn.from[k]] - at[turn.from[k]] : at[turn.from[k]];
  return out;
}
Vec3d turned_back(const Turn& turn, const Vec3d& at, const Vec3d& upright_size) {
  Vec3d out;
  for (std::size_t k = 0; k < 3; ++k)
    out[turn.from[k]] = turn.mirrored[k] ? upright_size[turn.from[k]] - at[k] : at[k];
  return out;
}

/// A scene with a lid, turned with its water, its bodies and its gravity.
sim::Scene turned(const Turn& turn, sim::Scene scene) {
  const Vec3d size = scene.tank_size_m;
  for (sim::WaterBlock& block : scene.water) {
    const Vec3d a = turned(turn, block.min_m, size), b = turned(turn, block.max_m, size);
    for (std::size_t k = 0; k < 3; ++k) {
      block.min_m[k] = std::min(a[k], b[k]);
      block.max_m[k] = std::max(a[k], b[k]);
    }
  }
  for (sim::Obstacle& o : scene.obstacles) o.start.centre_m = turned(turn, o.start.centre_m, size);
  Vec3d along{}, tank{};
  for (std::size_t k = 0; k < 3; ++k) {
    tank[k] = size[turn.from[k]];
    if (turn.from[k] == 1) along[k] = turn.mirrored[k] ? g : -g;
  }
  scene.tank_size_m = tank;
  scene.gravity_m_s2 = {along[0], along[1], along[2]};
  scene.lid = true;
  return scene;
}

struct Water {
  Vec3d centre{};  ///< in the upright scene's axes
  double speed = 0, lowest = 1e9, fastest = 0;
};
Water water_of(const sim::Simulation& fluid, const Turn& turn, const Vec3d& upright_size) {
  Water out;
  const auto state = fluid.read_state();
  for (const ParticleState& p : state) {
    const Vec3d at = turned_back(
        turn, {static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)},
        upright_size);
    for (std::size_t k = 0; k < 3; ++k) {
      out.centre[k] += at[k] / static_cast<double>(state.size());
      EXPECT_GE(at[k], -1e-5);
      EXPECT_LE(at[k], upright_size[k] + 1e-5);
    }
    out.lowest = std::min(out.lowest, at[1]);
    out.fastest = std::max(out.fastest, sim::cases::speed(p));
  }
  out.speed = fluid_test::rms_speed(state);
  return out;
}

/// A settled pool of 8 layers. Its rms speed must stay below case S1's bound, 0.02 sqrt(g H).
void pool_rests_as_upright(Backend backend) {
  auto scene = fluid_test::tank({8 * d, 16 * d, 8 * d}, {8 * d, 8 * d, 8 * d}, 30);
  sim::SimulationOptions options;
  options.n_star = 64;
  options.backend = backend;
  const auto rested = [&](const Turn& turn) {
    const auto fluid = sim::make_simulation(turned(turn, scene), options);
    for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
    EXPECT_FALSE(fluid->divergence());
    return water_of(*fluid, turn, scene.tank_size_m);
  };
  const Water here = rested(upright);
  const double fall = std::sqrt(g * 8 * d);
  EXPECT_LT(here.speed, 0.02 * fall);
  for (const Turn& turn : turns) {
    SCOPED_TRACE(turn.name);
    const Water there = rested(turn);
    EXPECT_LT(there.speed, 0.02 * fall);
    EXPECT_NEAR(there.speed, here.speed, 0.01 * fall);
    EXPECT_NEAR(there.centre[1], here.centre[1], 0.005 * here.centre[1]);
    EXPECT_LT(there.lowest, 0.5 * d) << "it rests at the wall";
    std::printf("%s: centre %.4f m (upright %.4f), v_rms %.4f m/s (%.4f)\n", turn.name, there.centre[1],
                here.centre[1], there.speed, here.speed);
  }
}
TEST(Gravity, ATurnedPoolRestsAsUpright) { pool_rests_as_upright(Backend::Cpu); }
TEST(GravityGpu, ATurnedPoolRestsAsUpright) { pool_rests_as_upright(Backend::Cuda); }

/// While the water settles, the gate holds the block on all sides except that from which gravity comes. After
/// it opens, the front runs 2 m in a third of a second.
void dam_breaks_as_upright(Backend backend) {
  auto scene = fluid_test::tank({16 * d, 12 * d, 8 * d}, {8 * d, 8 * d, 8 * d}, 20);
  scene.gate = true;
  sim::SimulationOptions options;
  options.n_star = 64;
  options.backend = backend;
  const auto broken = [&](const Turn& turn) {
    const auto fluid = sim::make_simulation(turned(turn, scene), options);
    const Water before = water_of(*fluid, turn, scene.tank_size_m);
    EXPECT_NEAR(before.centre[0], 4 * d, 0.2 * d) << "the gate holds";
    for (int frame = 0; frame < 20; ++frame) fluid->step_frame();
    EXPECT_FALSE(fluid->divergence());
    return water_of(*fluid, turn, scene.tank_size_m);
  };
  const Water here = broken(upright);
  EXPECT_GT(here.centre[0], 5 * d);
  for (const Turn& turn : turns) {
    SCOPED_TRACE(turn.name);
    const Water there = broken(turn);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(there.centre[k], here.centre[k], 0.1 * d) << k;
    EXPECT_NEAR(there.speed, here.speed, 0.03 * here.speed);
  }
}
TEST(Gravity, ATurnedDamBreaksAsUpright) { dam_breaks_as_upright(Backend::Cpu); }
TEST(GravityGpu, ATurnedDamBreaksAsUpright) { dam_breaks_as_upright(Backend::Cuda); }

/// Depth of the centre of a ball of half the water's density below the upright water's top, in radii.
double floating_depth(const Turn& turn, Backend backend) {
  constexpr double radius = 0.25;
  auto scene = fluid_test::tank({1, 1.5, 1}, {1, 1, 1}, 30);
  scene.v_ref_m_s = 3;
  sim::Obstacle ball;
  ball.radius_m = radius;
  ball.start.centre_m = {0.5, 0.9, 0.5};
  ball.motion = sim::ObstacleMotion::Free;
  ball.density_kg_m3 = 500;
  scene.obstacles = {ball};
  sim::SimulationOptions options;
  options.n_star = 128;
  options.backend = backend;
  const auto fluid = sim::make_simulation(turned(turn, scene), options);
  double height = 0;
  constexpr int frames = 60, last = 20;
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    const Vec3d at = turned_back(turn, fluid->read_obstacles().at(0).pose.centre_m, scene.tank_size_m);
    if (frame >= frames - last) height += at[1] / last;
  }
  EXPECT_FALSE(fluid->divergence());
  // The top of the water lies at twice the height of its centre.
  const double water = 2 * water_of(*fluid, turn, scene.tank_size_m).centre[1];
  return (water - height) / radius;
}
void ball_floats(Backend backend) {
  const double here = floating_depth(upright, backend);
  EXPECT_NEAR(here, 0, 0.3);
  for (const Turn& turn : {on_its_right, upside_down}) {
    SCOPED_TRACE(turn.name);
    EXPECT_NEAR(floating_depth(turn, backend), here, 0.15);
  }
}
TEST(Gravity, ABallFloatsAgainstIt) { ball_floats(Backend::Cpu); }
TEST(GravityGpu, ABallFloatsAgainstIt) { ball_floats(Backend::Cuda); }

/// Gravity along no axis: the forces change the momentum by m g t, and once the water rests, the walls,
/// including the lid, take up the same amount.
void account_closes(Backend backend) {
  auto scene = fluid_test::tank({8 * d, 12 * d, 8 * d}, {8 * d, 8 * d, 8 * d}, 60);
  scene.lid = true;
  scene.gravity_m_s2 = {3, 8, -4};
  sim::SimulationOptions options;
  options.n_star = 64;
  options.backend = backend;
  options.gauges = {{"lid", Wall::Lid, {0, 0, 0}, {8 * d, 0, 8 * d}},
                    {"high half", Wall::HighX, {0, 6 * d, 0}, {0, 12 * d, 8 * d}},
                    {"low half", Wall::HighX, {0, 0, 0}, {0, 6 * d, 8 * d}}};
  EXPECT_NEAR(sim::area_m2({"tall", Wall::HighX, {0, 0, 0}, {0, 99, 99}}, scene.room_m()), 96 * d * d, 1e-12);
  const auto fluid = sim::make_simulation(scene, options);
  const double mass = 1000 * 512 * d * d * d, time_s = scene.frame_dt_s;
  Vec3d walls{}, change{};
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    const auto account = fluid->momentum();
    const auto of_walls = account.walls_sum();
    const double stroke = mass * g * time_s;
    const auto wall = [&](Wall which) { return account.walls[static_cast<std::size_t>(which)].sum(); };
    EXPECT_NEAR(account.gauges[0].sum(), wall(Wall::Lid), 1e-5 * stroke);
    EXPECT_NEAR(account.gauges[1].sum() + account.gauges[2].sum(), wall(Wall::HighX), 1e-5 * stroke);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(account.forces[k], mass * scene.gravity_m_s2.along[k] * time_s, 1e-5 * stroke);
      EXPECT_NEAR(account.unattributed[k], 0, 5e-3 * stroke);
      walls[k] += of_walls[k];
      change[k] += account.after[k] - account.before[k];
    }
  }
  const double impulse = mass * g * frames * time_s;
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(walls[k], change[k] - mass * scene.gravity_m_s2.along[k] * frames * time_s, 1e-3 * impulse);
  EXPECT_GT(std::abs(walls[1]), 0.7 * impulse) << "the lid holds the water";
}
TEST(Gravity, TheAccountOfMomentumClosesAlongAnyDirection) { account_closes(Backend::Cpu); }
TEST(GravityGpu, TheAccountOfMomentumClosesAlongAnyDirection) { account_closes(Backend::Cuda); }

/// Water that falls across a closed tank into its far corner, with splits and merges where the method has
/// them. Its speed may be at most twice that of a fall along the tank's diagonal.
void methods_follow(Backend backend) {
  auto scene = fluid_test::tank({12 * d, 12 * d, 12 * d}, {8 * d, 8 * d, 8 * d});
  scene.lid = true;
  scene.gravity_m_s2 = {5, 6, 5};
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    sim::SimulationOptions options;
    options.method = method.kind;
    options.n_star = method.kind == MethodKind::LoRes ? 512 : 64;
    options.backend = backend;
    if (method.adaptive()) options.forced_targets = sim::TargetRegion{{12 * d, 6 * d, 6 * d}, 6 * d, 0, 3};
    const auto fluid = sim::make_simulation(scene, options);
    const Vec3d before = water_of(*fluid, upright, scene.tank_size_m).centre;
    const double fall = std::sqrt(2 * scene.gravity_m_s2.size() * 12 * d * std::sqrt(3));
    for (int frame = 0; frame < 45; ++frame) {
      fluid->step_frame();
      EXPECT_LT(water_of(*fluid, upright, scene.tank_size_m).fastest, 2 * fall);
    }
    EXPECT_FALSE(fluid->divergence());
    const Vec3d after = water_of(*fluid, upright, scene.tank_size_m).centre;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(after[k], before[k] + 2 * d) << k;
  }
}
TEST(Gravity, AllMethodsFollowIt) { methods_follow(Backend::Cpu); }
TEST(GravityGpu, AllMethodsFollowIt) { methods_follow(Backend::Cuda); }

/// A nozzle's mouth is under water, in tanks that are nine tenths full and full.
void nozzle_leaves_a_closed_tank_whole(Backend backend) {
  for (const auto& [layers, speed] : {std::pair{9.0, 2.0}, std::pair{10.0, 2.0}, std::pair{10.0, 6.0}}) {
    SCOPED_TRACE(testing::Message() << layers << " layers, " << speed << " m/s");
    auto scene = fluid_test::tank({10 * d, 10 * d, 10 * d}, {10 * d, layers * d, 10 * d}, 20);
    scene.lid = true;
    scene.v_ref_m_s = 6;
    scene.nozzles = {{3 * d, {5 * d, 8 * d, 5 * d}, speed, 1000, 0}};
    scene.recirculation_corner_m = 3 * d;
    sim::SimulationOptions options;
    options.n_star = std::lround(100 * layers / 8);
    options.backend = backend;
    const auto fluid = sim::make_simulation(scene, options);
    const auto count = fluid->particle_count();
    for (int frame = 0; frame < 60; ++frame) {
      fluid->step_frame();
      EXPECT_LT(water_of(*fluid, upright, scene.tank_size_m).fastest, 8);
    }
    EXPECT_FALSE(fluid->divergence());
    EXPECT_EQ(fluid->particle_count(), count);
    const auto report = fluid->report();
    EXPECT_GT(report.poured, 80);
    EXPECT_LT(report.density_error_mean, 0.02);
    std::printf("%.0f layers, %.0f m/s: poured %lld, density error %.4f\n", layers, speed,
                static_cast<long long>(report.poured), report.density_error_mean);
  }
}
TEST(Lid, ANozzleLeavesAClosedTankWhole) { nozzle_leaves_a_closed_tank_whole(Backend::Cpu); }
TEST(LidGpu, ANozzleLeavesAClosedTankWhole) { nozzle_leaves_a_closed_tank_whole(Backend::Cuda); }

void outlet_in_the_lid_drains(Backend backend) {
  auto scene = fluid_test::tank({8 * d, 12 * d, 8 * d}, {8 * d, 8 * d, 8 * d}, 10);
  scene.lid = true;
  scene.gravity_m_s2 = {0, g, 0};
  scene.outlets.push_back({Wall::Lid, {0, 0}, {8 * d, 8 * d}});
  sim::SimulationOptions options;
  options.n_star = 64;
  options.backend = backend;
  const auto fluid = sim::make_simulation(scene, options);
  EXPECT_EQ(fluid->particle_count(), 512) << "it is shut while the water settles";
  for (int frame = 0; frame < 50; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->particle_count(), 0);
  EXPECT_FALSE(fluid->divergence());
}
TEST(Lid, AnOutletInItDrainsUpwards) { outlet_in_the_lid_drains(Backend::Cpu); }
TEST(LidGpu, AnOutletInItDrainsUpwards) { outlet_in_the_lid_drains(Backend::Cuda); }

std::string scene_text(const std::string& file, const std::string& gravity, bool lid) {
  std::string text = base::read_file(base::resource("data/scenes/" + file), 1 << 20);
  const auto key = text.find("gravity_m_s2 =");
  text.replace(key, text.find('\n', key) - key, "gravity_m_s2 = " + gravity);
  if (lid) text.insert(text.find('\n', text.find("[tank]")) + 1, "lid = true\n");
  return text;
}

TEST(Gravity, IsReadAsANumberOrAVector) {
  const auto read = [](const std::string& gravity, bool lid) {
    return sim::parse_scene(scene_text("single_dam.toml", gravity, lid), "scene.toml");
  };
  EXPECT_EQ(read("9.81", false).gravity_m_s2.along, (Vec3d{0, -9.81, 0}));
  EXPECT_EQ(read("[1.0, -2, 0.5]", false).gravity_m_s2.along, (Vec3d{1, -2, 0.5}));
  EXPECT_EQ(read("[9.81, 0.0, 0.0]", true).gravity_m_s2.up(), (Vec3d{-1, 0, 0}));
  EXPECT_EQ(read("[0, 0, 0]", false).gravity_m_s2.size(), 0);
  EXPECT_FALSE(read("9.81", false).lid);
  EXPECT_TRUE(read("9.81", true).lid);
}

TEST(Gravity, RefusalsNameTheKeyAndTheMend) {
  using testing::AllOf;
  using testing::HasSubstr;
  const auto refused = [](const std::string& gravity, bool lid) {
    return fluid_test::scene_error(scene_text("single_dam.toml", gravity, lid));
  };
  const auto of_key = [](const char* problem, const char* mend) {
    return AllOf(HasSubstr("scene.toml:"), HasSubstr("'gravity_m_s2'"), HasSubstr(problem),
                 HasSubstr("mend:"), HasSubstr(mend));
  };
  EXPECT_THAT(refused("-1", false), of_key("out of range", "[0, 1000]"));
  EXPECT_THAT(refused("[0, -9.81]", false), of_key("has 2 entries", "exactly 3"));
  EXPECT_THAT(refused("[0, -1001, 0]", false), of_key("out of range", "[-1000, 1000]"));
  EXPECT_THAT(refused("[800, -800, 0]", false), of_key("out of range", "at most 1000"));
  EXPECT_THAT(refused("[0, nan, 0]", false), of_key("finite", "ordinary number"));
  EXPECT_THAT(refused("[0, \"x\", 0]", false), of_key("must be a number", "quotes"));
  for (const char* gravity : {"[0, 9.81, 0]", "[9.81, 0, 0]"}) {
    EXPECT_THAT(refused(gravity, false), of_key("open at the top", "lid = true"));
    EXPECT_EQ(refused(gravity, true), "no error");
  }
}

TEST(Lid, RefusesWhatReachesThroughIt) {
  using testing::AllOf;
  using testing::HasSubstr;
  const auto refused = [](const std::string& file, const std::string& from, const std::string& to,
                          bool lid = true) {
    std::string text = scene_text(file, "9.81", lid);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return fluid_test::scene_error(text.replace(at, from.size(), to));
  };
  const std::string dam = "single_dam.toml";
  const auto tank = sim::parse_scene(scene_text(dam, "9.81", true), "scene.toml").tank_size_m;
  EXPECT_THAT(refused(dam, "lid = true", "lid = 1"),
              AllOf(HasSubstr("'tank.lid'"), HasSubstr("true or false")));
  const auto block = "min_m = [0.0, 0.0, 0.0]\nmax_m = [1.0, " + std::to_string(tank[1] + 0.1) + ", 1.0]\n";
  for (const bool lid : {false, true}) {
    const std::string text = scene_text(dam, "9.81", lid);
    const auto from = text.find("min_m"), to = text.find('\n', text.find("max_m")) + 1;
    const auto error = fluid_test::scene_error(std::string(text).replace(from, to - from, block));
    EXPECT_EQ(error.find("reaches outside the tank") != std::string::npos, lid) << error;
    const std::string outlet = "\n[[outlet]]\nwall = \"y_high\"\nmin_m = [0.0, 0.0]\nmax_m = [1.0, 1.0]\n";
    EXPECT_EQ(fluid_test::scene_error(text + outlet).find("lid = true") != std::string::npos, !lid);
    const std::string ball = "\n[[obstacle]]\nshape = \"sphere\"\nradius_m = 0.5\ncentre_m = [1.0, " +
                             std::to_string(tank[1]) + ", 1.0]\n";
    const auto of_ball =
        fluid_test::scene_error(std::regex_replace(text, std::regex("format = 1"), "format = 2") + ball);
    EXPECT_EQ(of_ball.find("outside the tank") != std::string::npos, lid) << of_ball;
  }
  const auto faucet = sim::parse_scene(scene_text("faucet.toml", "9.81", false), "scene.toml");
  auto closed = faucet;
  closed.lid = true;
  const auto& nozzle = faucet.nozzles[0];
  const double room = closed.tank_size_m[1] - nozzle.position_m[1];
  EXPECT_NEAR(sim::beyond_lid_m(closed, nozzle, 1.0 / 60), nozzle.speed_m_s / 60 - room, 1e-9);
  EXPECT_LT(sim::beyond_lid_m(faucet, nozzle, 1), 0);
  closed.tank_size_m[1] = nozzle.position_m[1] + 1e-3;
  sim::SimulationOptions options;
  options.n_star = 64;
  EXPECT_THROW(sim::make_simulation(closed, options), base::Error);
}

}  // namespace
