/// What the walls give the water: the account of its momentum, and gauges.

#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;
using sim::Gauge;
using sim::Vec3d;
using sim::Wall;

constexpr double d = 0.15;
constexpr double gravity = 9.81;

/// A settled column of 8 x 16 x 8 spacings, 2.4 m deep.
struct Column {
  static constexpr int layers = 16;
  sim::Scene scene = fluid_test::tank({8 * d, 24 * d, 8 * d}, {8 * d, layers* d, 8 * d}, 60);
  sim::SimulationOptions options;
  double weight = 1000 * gravity * 64 * layers * d * d * d;  ///< N

  explicit Column(Backend backend) {
    options.n_star = 8 * layers;
    options.backend = backend;
  }
};

void account_closes_over_walls_and_gauges(Backend backend) {
  Column column(backend);
  column.options.gauges = {{"near half", Wall::Floor, {0, 0, 0}, {8 * d, 0, 4 * d}},
                           {"far half", Wall::Floor, {0, 0, 4 * d}, {8 * d, 0, 8 * d}},
                           {"low side", Wall::HighX, {0, 0, 0}, {0, 8 * d, 8 * d}},
                           {"high side", Wall::HighX, {0, 8 * d, 0}, {0, 30 * d, 8 * d}}};
  const auto fluid = sim::make_simulation(column.scene, column.options);
  EXPECT_EQ(fluid->momentum().gauges.size(), 0u) << "no frame yet";
  Vec3d last{};
  for (int frame = 0; frame < 10; ++frame) {
    fluid->step_frame();
    const auto account = fluid->momentum();
    ASSERT_EQ(account.gauges.size(), 4u);
    const auto wall = [&](Wall which) { return account.walls[static_cast<std::size_t>(which)]; };
    const double stroke = column.weight / 60;
    // A gauge holds all parts of its share of the wall: 1e-5 is the rounding of single squares.
    EXPECT_NEAR(account.gauges[0].sum() + account.gauges[1].sum(), wall(Wall::Floor).sum(), 1e-5 * stroke);
    EXPECT_NEAR(account.gauges[2].sum() + account.gauges[3].sum(), wall(Wall::HighX).sum(), 1e-5 * stroke);
    EXPECT_NEAR(account.gauges[2].coarse_pressure + account.gauges[3].coarse_pressure,
                wall(Wall::HighX).coarse_pressure, 1e-5 * stroke);
    EXPECT_GT(account.gauges[2].sum(), account.gauges[3].sum());
    const auto walls = account.walls_sum();
    EXPECT_NEAR(account.forces[1], -stroke, 1e-5 * stroke);
    for (std::size_t k = 0; k < 3; ++k) {
      if (frame > 0) {
        EXPECT_EQ(account.before[k], last[k]);
      }
      last[k] = account.after[k];
      EXPECT_NEAR(account.after[k] - account.before[k],
                  account.forces[k] + walls[k] + account.viscosity[k] + account.unattributed[k],
                  1e-9 * stroke);
    }
  }
}
TEST(WallImpulse, TheAccountClosesOverWallsAndGauges) { account_closes_over_walls_and_gauges(Backend::Cpu); }
TEST(WallImpulseGpu, TheAccountClosesOverWallsAndGauges) {
  account_closes_over_walls_and_gauges(Backend::Cuda);
}

void asking_changes_no_bit(Backend backend) {
  Column column(backend);
  column.options.start = sim::make_simulation(column.scene, column.options)->read_state();
  column.scene.tank_size_m[0] *= 2;  // now it is a dam
  std::vector<ParticleState> ends[2];
  for (const bool asked : {false, true}) {
    column.options.wall_impulse = asked;
    const auto fluid = sim::make_simulation(column.scene, column.options);
    for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
    ends[asked] = fluid->read_state();
    EXPECT_EQ(fluid->momentum().forces[1] != 0, asked);
    EXPECT_EQ(fluid->explain().find("walls' density") < fluid->explain().find("  -  "), asked);
  }
  ASSERT_EQ(ends[0].size(), ends[1].size());
  for (std::size_t i = 0; i < ends[0].size(); ++i) {
    ASSERT_EQ(ends[0][i].x_m, ends[1][i].x_m) << i;
    ASSERT_EQ(ends[0][i].vy_m_s, ends[1][i].vy_m_s) << i;
  }
}
TEST(WallImpulse, AskingChangesNoBit) { asking_changes_no_bit(Backend::Cpu); }
TEST(WallImpulseGpu, AskingChangesNoBit) { asking_changes_no_bit(Backend::Cuda); }

TEST(WallImpulse, AGaugeWithoutAreaIsNamed) {
  Column column(Backend::Cpu);
  column.scene.settle_frames = 0;
  const Gauge good{"p1", Wall::HighX, {0, 0.1, 0.2}, {0, 0.4, 0.6}};
  EXPECT_NEAR(sim::area_m2(good, column.scene.tank_size_m), 0.12, 1e-12);
  EXPECT_NEAR(sim::area_m2({"all", Wall::Floor, {-9, 0, -9}, {9, 0, 9}}, column.scene.tank_size_m),
              64 * d * d, 1e-12);
  for (const Gauge& bad : {Gauge{"thin", Wall::HighX, {0, 0.1, 0.2}, {0, 0.1, 0.6}},
                           Gauge{"outside", Wall::Floor, {9, 0, 0}, {10, 0, 1}}}) {
    column.options.gauges = {bad};
    EXPECT_THROW(sim::make_simulation(column.scene, column.options), base::Error) << bad.name;
  }
}

}  // namespace
