#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

#include "libsim/exec/bandwidth.hpp"
#include "libsim/measure/launch_table.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;

/// A fluid of 1,024 particles, if all particles are of the finest level.
std::unique_ptr<sim::Simulation> few(sim::MethodKind method) {
  sim::SimulationOptions options;
  options.method = method;
  options.n_star = 128;
  if (method != sim::MethodKind::HiRes) options.forced_targets = sim::TargetRegion{{0, 0, 0}, 0.5, 0, 2};
  return sim::make_simulation(sim::read_scene(base::resource("data/scenes/peers_dam.toml")), options);
}

/// Labels of the passes that are launched in 12 frames.
std::set<std::string> labels_of(sim::MethodKind method) {
  const auto fluid = few(method);
  fluid->profile_launches(true);
  for (int frame = 0; frame < 12; ++frame) fluid->step_frame();
  std::set<std::string> out;
  for (const auto& pass : fluid->launch_times()) out.insert(pass.label);
  fluid->profile_launches(false);
  return out;
}

// The table pass_bytes() finds a pass by its label, so a renamed pass would lose its lower bound of bytes
// without an error.
TEST(PassBytes, EveryPassOfTheTableIsLaunched) {
  auto launched = labels_of(sim::MethodKind::HiRes);
  EXPECT_FALSE(launched.contains("density beside fresh"));
  launched.merge(labels_of(sim::MethodKind::Ours));
  for (const auto& pass : measure::pass_bytes()) EXPECT_TRUE(launched.contains(pass.label)) << pass.label;
  // A launch over few particles moves fewer bytes than one over all, so it has another label and no lower
  // bound.
  EXPECT_TRUE(launched.contains("density beside fresh"));
  EXPECT_TRUE(launched.contains("displacement beside fresh"));
  EXPECT_FALSE(measure::least_bytes("density beside fresh", {}));
}

TEST(PassBytes, TheTableHasAsManyBytesAsTheFunctorsMove) {
  const measure::PassWater water{.particles = 1000, .solved_share = 1, .listed = 50};
  // Bytes of each particle: position and support 16, count 4, two results of 4, and 50 list entries of 4.
  EXPECT_EQ(measure::least_bytes("density", water), 1000 * (16 + 4 + 4 + 4 + 50 * 4));
  EXPECT_EQ(measure::least_bytes("displacement", water), 1000 * (16 + 4 + 4 + 16 + 50 * 4));
  EXPECT_EQ(measure::least_bytes("list neighbours", water), 1000 * (16 + 4 + 50 * 4));
  EXPECT_EQ(measure::least_bytes("xsph", water), 1000 * (16 + 16 + 4 + 4 + 16 + 50 * 4));
  EXPECT_EQ(measure::least_bytes("ease", water), 1000 * (1 + 4 + 4 + 50 * 4));
  EXPECT_EQ(measure::least_bytes("predict", water), 1000 * 80);
  EXPECT_EQ(measure::least_bytes("velocity", water), 1000 * 80);
  EXPECT_EQ(measure::least_bytes("shift", water), 1000 * 32);
  EXPECT_EQ(measure::least_bytes("gather cells", water), 1000 * 20);
  EXPECT_EQ(measure::least_bytes("reorder", water), 1000 * (4 + 2 * 53));
  EXPECT_EQ(measure::least_bytes("count cells", water), 1000 * 24);
  EXPECT_EQ(measure::least_bytes("place by cell", water), 1000 * 12);
  EXPECT_EQ(measure::least_bytes("order within cells", water), 1000 * 16);
  EXPECT_EQ(measure::pass_bytes().size(), 13u);
}

TEST(PassBytes, WhoRestsIsLeftOutWhereOnlyTheSolvedAreVisited) {
  const measure::PassWater half{.particles = 1000, .solved_share = 0.5, .listed = 10};
  EXPECT_EQ(measure::least_bytes("density", half), 500 * 68);
  EXPECT_EQ(measure::least_bytes("predict", half), 1000 * 80);
}

TEST(PassBytes, ListsAreAsLongAsBruteForceFindsThem) {
  const auto fluid = few(sim::MethodKind::HiRes);
  for (int frame = 0; frame < 3; ++frame) fluid->step_frame();
  std::vector<sim::RenderParticle> particles;
  fluid->read_particles(particles);
  double pairs = 0;
  for (const auto& a : particles) {
    const float reach = 1.1f * 4 * a.radius_m;  // the lists' margin; h = 4 r
    for (const auto& b : particles)
      pairs += &a != &b && std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m) < reach;
  }
  EXPECT_NEAR(fluid->report().listed_mean, pairs / static_cast<double>(particles.size()), 0.01);
}

TEST(PassBytes, TheFloorIsBytesOverBandwidth) {
  const measure::PassWater water{.particles = 1e6, .solved_share = 1, .listed = 50};
  // 12 launches of 80 MB at 1,000 GB/s: 0.96 ms; 2.4 ms is 2.5 times that.
  const auto floor = measure::floor_of("predict", 12, 2.4, water, 1000);
  ASSERT_TRUE(floor);
  EXPECT_DOUBLE_EQ(floor->bytes_a_frame, 960e6);
  EXPECT_DOUBLE_EQ(floor->ms_a_frame, 0.96);
  EXPECT_DOUBLE_EQ(floor->times, 2.5);
  EXPECT_FALSE(measure::floor_of("classify cells", 12, 2.4, water, 1000));
}

TEST(PassBytes, ListsOfUnknownLengthHaveNoFloor) {
  const measure::PassWater water{.particles = 10};
  EXPECT_FALSE(measure::floor_of("density", 1, 1, water, 1));
  EXPECT_TRUE(measure::floor_of("predict", 1, 1, water, 1));
}

TEST(PassBytes, TheTableOfLaunchesHoldsBoth) {
  measure::LaunchSums sums;
  sums.add({{"predict", 1, 0.5}, {"classify cells", 2, 1.5}});
  sums.add({{"predict", 1, 0.5}});
  const measure::PassWater water{.particles = 1e6, .solved_share = 1, .listed = 50};
  const auto launches = measure::launches_json(sums.all(), 2, water, 200);
  ASSERT_EQ(launches.size(), 2u);
  EXPECT_EQ(launches[0]["pass"], "classify cells");
  EXPECT_TRUE(launches[0]["times_floor"].is_null());
  EXPECT_EQ(launches[1]["launches_a_frame"], 1);
  EXPECT_DOUBLE_EQ(launches[1]["ms_a_frame"].get<double>(), 0.5);
  EXPECT_DOUBLE_EQ(launches[1]["bytes_a_frame"].get<double>(), 80e6);
  EXPECT_DOUBLE_EQ(launches[1]["floor_ms_a_frame"].get<double>(), 0.4);
  EXPECT_DOUBLE_EQ(launches[1]["times_floor"].get<double>(), 1.25);
  const std::string lines = measure::launch_lines(launches, 200);
  for (const char* part : {"200.0 GB/s", "times floor", "80.00", "0.4000", "1.25", "          -\n"})
    EXPECT_THAT(lines, HasSubstr(part));
}

TEST(PassBytes, TheMemoryHasABandwidth) { EXPECT_GT(sim::copy_bandwidth_gb_s(sim::Backend::Cpu), 0); }

}  // namespace
}  // namespace apps
