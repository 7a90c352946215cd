/// Impulses of the walls on the water: the account of its momentum, and gauges.

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "stats/base/error.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

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
    // Two gauges cover a wall, so their sums must equal the wall's up to rounding (1e-5).
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
      EXPECT_NEAR(
          account.after[k] - account.before[k],
          account.forces[k] + walls[k] + account.viscosity[k] + account.effects[k] + account.unattributed[k],
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

/// Change of the water's momentum and impulses on it, summed over frames, as shares of the impulse of the
/// column's weight in these frames.
struct Books {
  double change = 0, forces = 0, walls = 0;  ///< along y
  double open = 0;                  ///< change that forces and walls do not explain, the largest component
  std::vector<double> pressure_pa;  ///< mean pressure at each gauge
};

Books books_of(sim::Simulation& fluid, const Column& column, int frames) {
  Books out;
  Vec3d open{};
  out.pressure_pa.resize(column.options.gauges.size());
  for (int frame = 0; frame < frames; ++frame) {
    fluid.step_frame();
    const auto account = fluid.momentum();
    const auto walls = account.walls_sum();
    for (std::size_t k = 0; k < 3; ++k)
      open[k] += account.after[k] - account.before[k] - account.forces[k] - walls[k];
    out.change += account.after[1] - account.before[1];
    out.forces += account.forces[1];
    out.walls += walls[1];
    for (std::size_t k = 0; k < out.pressure_pa.size(); ++k) {
      const double area = sim::area_m2(column.options.gauges[k], column.scene.room_m());
      out.pressure_pa[k] += account.gauges[k].sum() / (area * frames * column.scene.frame_dt_s);
    }
  }
  const double impulse = column.weight * frames * column.scene.frame_dt_s;
  for (double* sum : {&out.change, &out.forces, &out.walls}) *sum /= impulse;
  for (const double part : open) out.open = std::max(out.open, std::abs(part) / impulse);
  return out;
}

/// Moves a region of fine water, with splits and merges round it.
void wander(sim::Simulation& fluid, int frame) {
  fluid.force_targets({{4 * d, 8 * d * (1 + std::sin(0.3 * frame)), 8 * d}, 5 * d, 0, 3});
}

void ledger_closes(Backend backend, bool ours, bool dam) {
  Column column(backend);
  column.options.start = sim::make_simulation(column.scene, column.options)->read_state();
  if (dam) column.scene.tank_size_m[0] *= 3;
  column.options.wall_impulse = true;
  if (ours) {
    column.options.method = sim::MethodKind::Ours;
    column.options.forced_targets = sim::TargetRegion{{4 * d, 8 * d, 8 * d}, 5 * d, 0, 3};
  }
  const auto fluid = sim::make_simulation(column.scene, column.options);
  Books all;
  constexpr int parts = 12;
  for (int part = 0; part < parts; ++part) {
    if (ours) wander(*fluid, part * 5);
    const auto books = books_of(*fluid, column, 5);
    // `open` is a share of the weight's impulse over these five frames.
    EXPECT_LT(books.open, 1e-3) << "frames " << part * 5 << " to " << part * 5 + 4;
    all.change += books.change / parts;
    all.walls += books.walls / parts;
    all.open = std::max(all.open, books.open);
  }
  const auto levels = fluid->report().levels;
  std::printf("walls, %s %s: gave %.4f of the weight, change %.4f, open %.1e; %llu splits, %llu merges\n",
              ours ? "Ours" : "HiRes", dam ? "dam" : "tank", all.walls, all.change, all.open,
              static_cast<unsigned long long>(levels.splits), static_cast<unsigned long long>(levels.merges));
  EXPECT_NEAR(all.walls, 1 + all.change, 1e-3);
  EXPECT_EQ(levels.splits > 50 && levels.merges > 50, ours);
}
TEST(WallImpulse, TheLedgerOfATankCloses) {
  for (const bool ours : {false, true}) ledger_closes(Backend::Cpu, ours, false);
}
TEST(WallImpulse, TheLedgerOfADamCloses) {
  for (const bool ours : {false, true}) ledger_closes(Backend::Cpu, ours, true);
}
TEST(WallImpulseGpu, TheLedgersOfTankAndDamClose) {
  for (const bool ours : {false, true}) {
    for (const bool dam : {false, true}) ledger_closes(Backend::Cuda, ours, dam);
  }
}

void column_presses_by_its_depth(Backend backend, bool ours, double bound) {
  Column column(backend);
  if (ours) {
    column.options.method = sim::MethodKind::Ours;
    column.options.forced_targets = sim::TargetRegion{{4 * d, 8 * d, 8 * d}, 5 * d, 0, 3};
  }
  constexpr int bands = 8;
  const double height = Column::layers * d;
  for (int k = 0; k < bands; ++k) {
    column.options.gauges.push_back(
        {"band", Wall::HighX, {0, k * height / bands, 0}, {0, (k + 1) * height / bands, 8 * d}});
  }
  column.options.gauges.push_back({"floor", Wall::Floor, {2 * d, 0, 2 * d}, {6 * d, 0, 6 * d}});
  const auto fluid = sim::make_simulation(column.scene, column.options);
  for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
  const auto books = books_of(*fluid, column, 60);
  const auto truth = fluid_test::read_columns("data/truth/hydrostatic_column.csv");
  // A settled pool is a little lower than its volume over its floor (docs/results.md); its weight is the
  // same.
  double moment = 0;
  for (const auto& p : fluid->read_state()) moment += static_cast<double>(p.y_m) * (1 << p.level);
  const double depth = 2 * moment / static_cast<double>(fluid->report().mass_units);
  EXPECT_NEAR(depth / height, 1, 0.06);
  const auto expected = [&](double z) {  // Pa
    const auto& p = truth.at("p_Pa_for_H_1m");
    const double at = z / depth / 0.05;
    const auto low = std::min(static_cast<std::size_t>(at), p.size() - 2);
    return std::max(0.0, p[low] + (at - static_cast<double>(low)) * (p[low + 1] - p[low])) * height;
  };
  const double most = expected(0);
  double worst = 0;
  for (int k = 0; k < bands; ++k) {
    const double p = books.pressure_pa[static_cast<std::size_t>(k)];
    worst = std::max(worst, std::abs(p - expected((k + 0.5) * height / bands)) / most);
  }
  const double floor = books.pressure_pa.back() / most;
  std::printf(
      "column, %s: on the floor %.4f of rho g H, walls bear %.4f of the weight, of it %.4f for its own "
      "motion, profile within %.4f rho g H\n",
      ours ? "Ours" : "HiRes", floor, books.walls, books.change, worst);
  // If the column still moves after the second, the walls also gave it this momentum.
  EXPECT_NEAR(books.walls, 1 + books.change, 1e-3);
  EXPECT_LT(std::abs(books.change), 0.03);
  EXPECT_NEAR(floor, 1, 0.05);
  EXPECT_LT(worst, bound);
}
TEST(WallImpulse, AColumnPressesByItsDepth) {
  column_presses_by_its_depth(Backend::Cpu, false, 0.08);
  column_presses_by_its_depth(Backend::Cpu, true, 0.1);
}
TEST(WallImpulseGpu, AColumnPressesByItsDepth) {
  column_presses_by_its_depth(Backend::Cuda, false, 0.08);
  column_presses_by_its_depth(Backend::Cuda, true, 0.1);
}

/// A pool 1 m deep with a box on its floor, 0.5 m wide and 0.75 m high.
struct Pool {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  sim::Scene scene = fluid_test::tank({1.25, 1.5, 1.25}, {1.25, 1, 1.25}, 60);
  sim::SimulationOptions options;

  explicit Pool(Backend backend) {
    scene.v_ref_m_s = 3;
    scene.obstacles = {obstacle_test::box({0.625, 0.375, 0.625}, {0.5, 0.75, 0.5})};
    options.backend = backend;
    options.n_star = 512;
  }
  /// Launches of a pass in the next frame.
  static std::int64_t launches(sim::Simulation& fluid, const std::string& pass) {
    fluid.profile_launches(true);
    fluid.step_frame();
    std::int64_t out = 0;
    for (const auto& time : fluid.launch_times())
      out += pass.empty() || time.label == pass ? time.launches : 0;
    fluid.profile_launches(false);
    return out;
  }
};

void a_side_of_a_box_is_pressed_by_its_depth(Backend backend) {
  Pool pool(backend);
  // Six patches that cover the box: its side at +x and the rest of it, each in three bands of 0.25 m.
  for (const double low : {-Pool::inf, -0.125, 0.125}) {
    const double high = low < -1 ? -0.125 : low < 0 ? 0.125 : Pool::inf;
    pool.options.obstacle_gauges.push_back({"side", 0, {0.2, low, -1}, {1, high, 1}});
    pool.options.obstacle_gauges.push_back({"rest", 0, {-1, low, -1}, {0.2, high, 1}});
  }
  pool.options.obstacle_gauges.push_back({"all", 0});
  const auto fluid = sim::make_simulation(pool.scene, pool.options);
  for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
  constexpr int frames = 12;
  double force[3]{};
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    const auto account = fluid->momentum();
    ASSERT_EQ(account.obstacle_gauges.size(), 7u);
    const auto& whole = account.obstacles.at(0);
    for (std::size_t k = 0; k < 3; ++k) {
      double push = 0, turn = 0;
      for (std::size_t g = 0; g < 6; ++g) {
        push += account.obstacle_gauges[g].push[k];
        turn += account.obstacle_gauges[g].moment[k];
      }
      EXPECT_NEAR(push, whole.push[k], 1e-4) << "N s; a side bears some 10 in a frame";
      EXPECT_NEAR(turn, whole.moment[k], 1e-4);
      EXPECT_NEAR(account.obstacle_gauges[6].push[k], whole.push[k], 1e-9);
      EXPECT_NEAR(account.obstacle_gauges[6].moment[k], whole.moment[k], 1e-9);
    }
    for (std::size_t band = 0; band < 3; ++band)
      force[band] += account.obstacle_gauges[2 * band].push[0] / (frames * pool.scene.frame_dt_s);
  }
  // Settled water stands a little lower than its volume over the floor (docs/results.md), so its level is
  // measured.
  std::vector<double> heights;
  for (const auto& p : fluid->read_state()) heights.push_back(static_cast<double>(p.y_m));
  std::sort(heights.begin(), heights.end());
  const double level = heights[heights.size() * 98 / 100] + fluid->spacing_m() / 2;
  EXPECT_NEAR(level, 1, 0.05);
  for (std::size_t band = 0; band < 3; ++band) {
    const double foot = 0.25 * static_cast<double>(band);
    const double share = force[band] / (1000 * gravity * (level - foot - 0.125) * 0.25 * 0.5);
    std::printf("side of a box, from %.2f m: %.3f rho g h A, level %.3f m\n", foot, share, level);
    // The highest band ends at an edge, where water presses less: 0.91 was measured.
    EXPECT_NEAR(share, 1, band < 2 ? 0.1 : 0.15) << foot;
  }
}
TEST(ObstacleGauge, ASideOfABoxIsPressedByItsDepth) { a_side_of_a_box_is_pressed_by_its_depth(Backend::Cpu); }
TEST(ObstacleGaugeGpu, ASideOfABoxIsPressedByItsDepth) {
  a_side_of_a_box_is_pressed_by_its_depth(Backend::Cuda);
}

TEST(ObstacleGauge, AskingChangesNoBitAndNotAskingLaunchesNothing) {
  Pool pool(Backend::Cpu);
  pool.scene.settle_frames = 0;
  pool.options.wall_impulse = true;
  const auto without = sim::make_simulation(pool.scene, pool.options);
  pool.options.obstacle_gauges = {{"all", 0}};
  const auto with = sim::make_simulation(pool.scene, pool.options);
  const std::string pass = "record obstacles' cells";
  EXPECT_EQ(Pool::launches(*without, pass), 0);
  const auto launched = Pool::launches(*with, pass);
  EXPECT_EQ(launched, with->substeps().taken);
  const auto others = Pool::launches(*without, "");
  EXPECT_EQ(Pool::launches(*with, ""), others + 2 * with->substeps().taken) << "pressure and wetted area";
  const auto a = without->read_state(), b = with->read_state();
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

TEST(ObstacleGauge, PartsOfMovingBodiesAddUpUnderEffects) {
  NEEDS_EFFECTS;
  Pool pool(Backend::Cpu);
  pool.scene.settle_frames = 0;
  pool.scene.effects = {{sim::EffectKind::Viscosity, 0.05}, {sim::EffectKind::Friction, 0.5}};
  auto mesh =
      obstacle_test::mesh({0.9, 0.6, 0.9}, mesh_test::box_text({-0.2, -0.25, -0.15}, {0.2, 0.25, 0.15}));
  mesh.motion = sim::ObstacleMotion::Swings;
  mesh.way_m = {0.1, 0, 0.05};
  mesh.period_s = 1;
  pool.scene.obstacles = {obstacle_test::free_one(obstacle_test::sphere({0.35, 0.9, 0.35}, 0.25), 500), mesh};
  for (const std::size_t body : {0u, 1u}) {
    pool.options.obstacle_gauges.push_back({"left", body, {-1, -1, -1}, {0.05, 1, 1}});
    pool.options.obstacle_gauges.push_back({"right", body, {0.05, -1, -1}, {1, 1, 1}});
  }
  const auto fluid = sim::make_simulation(pool.scene, pool.options);
  for (int frame = 0; frame < 10; ++frame) {
    fluid->step_frame();
    const auto account = fluid->momentum();
    ASSERT_EQ(account.obstacle_gauges.size(), 4u);
    for (const std::size_t body : {0u, 1u}) {
      const auto &left = account.obstacle_gauges[2 * body], &right = account.obstacle_gauges[2 * body + 1];
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(left.push[k] + right.push[k], account.obstacles[body].push[k], 1e-3);
        EXPECT_NEAR(left.moment[k] + right.moment[k], account.obstacles[body].moment[k], 1e-3);
      }
    }
  }
}

TEST(ObstacleGauge, OnNoPartOfAnObstacleIsNamed) {
  Pool pool(Backend::Cpu);
  pool.scene.settle_frames = 0;
  for (const sim::ObstacleGauge& bad :
       {sim::ObstacleGauge{"of none", 1}, sim::ObstacleGauge{"thin", 0, {0.1, -1, -1}, {0.1, 1, 1}},
        sim::ObstacleGauge{"beside it", 0, {0.3, -1, -1}, {1, 1, 1}}}) {
    pool.options.obstacle_gauges = {bad};
    EXPECT_THROW(sim::make_simulation(pool.scene, pool.options), base::Error) << bad.name;
  }
}

TEST(WallImpulse, AGaugeWithoutAreaIsNamed) {
  Column column(Backend::Cpu);
  column.scene.settle_frames = 0;
  const Gauge good{"p1", Wall::HighX, {0, 0.1, 0.2}, {0, 0.4, 0.6}};
  EXPECT_NEAR(sim::area_m2(good, column.scene.room_m()), 0.12, 1e-12);
  EXPECT_NEAR(sim::area_m2({"all", Wall::Floor, {-9, 0, -9}, {9, 0, 9}}, column.scene.room_m()), 64 * d * d,
              1e-12);
  for (const Gauge& bad : {Gauge{"thin", Wall::HighX, {0, 0.1, 0.2}, {0, 0.1, 0.6}},
                           Gauge{"outside", Wall::Floor, {9, 0, 0}, {10, 0, 1}}}) {
    column.options.gauges = {bad};
    EXPECT_THROW(sim::make_simulation(column.scene, column.options), base::Error) << bad.name;
  }
}

}  // namespace
