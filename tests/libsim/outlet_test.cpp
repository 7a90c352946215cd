/// Outlets in the scene's file and in the schedule of passes; tests/stability tests the outflow (S15).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;

std::string dam_with(const std::string& tables) {
  return base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20) + "\n" + tables;
}

std::string error_of(const std::string& tables) {
  try {
    sim::parse_scene(dam_with(tables), "scene.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

const std::string good = "[[outlet]]\nwall = \"x_low\"\nmin_m = [0.5, 1.0]\nmax_m = [2.0, 3.0]\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(OutletScene, IsReadAlongTheWallsAxes) {
  const auto scene = sim::parse_scene(dam_with(good + replaced(good, "x_low", "y_low")), "scene.toml");
  ASSERT_EQ(scene.outlets.size(), 2u);
  EXPECT_EQ(scene.outlets[0].wall, sim::Wall::LowX);
  EXPECT_EQ(scene.outlets[0].min_m, (std::array{0.5, 1.0}));
  EXPECT_EQ(scene.outlets[0].max_m, (std::array{2.0, 3.0}));
  EXPECT_EQ(scene.outlets[1].wall, sim::Wall::Floor);
  EXPECT_EQ(sim::axes_of(sim::Wall::HighX), (std::array<std::size_t, 2>{1, 2}));
  EXPECT_EQ(sim::axes_of(sim::Wall::Floor), (std::array<std::size_t, 2>{0, 2}));
  EXPECT_EQ(sim::axes_of(sim::Wall::LowZ), (std::array<std::size_t, 2>{0, 1}));
}

TEST(OutletScene, ErrorsNameThePlaceAndTheMend) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_EQ(error_of(good), "no error");
  EXPECT_THAT(error_of(replaced(good, "x_low", "top")), AllOf(HasSubstr("wall"), HasSubstr("y_low")));
  EXPECT_THAT(error_of(replaced(good, "[2.0, 3.0]", "[0.5, 3.0]")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("max_m"), HasSubstr("leaves the outlet no area"),
                    HasSubstr("mend:")));
  EXPECT_THAT(error_of(replaced(good, "[2.0, 3.0]", "[2.0, 300.0]")), HasSubstr("reaches beyond the wall"));
  EXPECT_THAT(error_of(replaced(good, "[0.5, 1.0]", "[-0.5, 1.0]")),
              AllOf(HasSubstr("min_m"), HasSubstr("beyond the wall")));
  EXPECT_THAT(error_of(replaced(good, "[0.5, 1.0]", "[0.5, 1.0, 0.0]")), HasSubstr("min_m"));
  EXPECT_THAT(error_of(good + "speed_m_s = 1.0\n"), HasSubstr("speed_m_s"));
  EXPECT_THAT(error_of(good + good + good + good + good), HasSubstr("one outlet too many"));
}

void is_shut_while_the_water_settles(Backend backend) {
  auto scene = fluid_test::tank({1.2, 2.4, 1.2}, {1.2, 1.2, 1.2}, 10);
  scene.outlets.push_back({sim::Wall::Floor, {0, 0}, {1.2, 1.2}});
  sim::SimulationOptions options;
  options.n_star = 64;
  options.backend = backend;
  const auto fluid = sim::make_simulation(scene, options);
  EXPECT_EQ(fluid->particle_count(), 512);
  // Water falls 1.2 m in half a second.
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->particle_count(), 0);
  const auto report = fluid->report();
  EXPECT_EQ(report.particles_out, 512);
  EXPECT_EQ(report.drained, 512);
  EXPECT_EQ(report.mass_units, 0);
  EXPECT_EQ(fluid->account().particles(), 0);
  EXPECT_EQ(report.guards.not_finite, 0u);
}
TEST(Outlet, IsShutWhileTheWaterSettles) { is_shut_while_the_water_settles(Backend::Cpu); }
TEST(OutletGpu, IsShutWhileTheWaterSettles) { is_shut_while_the_water_settles(Backend::Cuda); }

TEST(Outlet, IsAbsentWhereTheSceneHasNone) {
  auto scene = fluid_test::tank({1.2, 2.4, 1.2}, {1.2, 1.2, 1.2});
  sim::SimulationOptions options;
  options.n_star = 64;
  EXPECT_THAT(sim::make_simulation(scene, options)->explain(),
              testing::HasSubstr("-  outflow             not called for"));
  scene.outlets.push_back({sim::Wall::Floor, {0, 0}, {1.2, 1.2}});
  EXPECT_THAT(sim::make_simulation(scene, options)->explain(), testing::HasSubstr("the scene has an outlet"));
}

}  // namespace
