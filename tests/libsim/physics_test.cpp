/// Water at rest does not move.

#include <gtest/gtest.h>

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;

void settled_dam_keeps_its_height(sim::Backend backend) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  sim::SimulationOptions options;
  options.n_star = 512;
  options.backend = backend;
  const auto fluid = sim::make_simulation(scene, options);
  const auto state = fluid->read_state();
  std::vector<double> heights;
  for (const auto& p : state) heights.push_back(static_cast<double>(p.y_m));
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() * 98 / 100),
                   heights.end());
  const double d = fluid->spacing_m();
  // In an unchanged block the 98th percentile of the heights is 98 % of the block's height.
  const double top = heights[heights.size() * 98 / 100] / 0.98;
  std::printf("settled dam: top %.3f m of 7.2, d = %.3f m, centre %.3f m\n", top, d,
              fluid_test::centre_height(state));
  EXPECT_NEAR(top, 7.2, d);
  EXPECT_NEAR(fluid_test::centre_height(state), 3.6, 0.04 * 3.6);
  EXPECT_EQ(fluid_test::outside(state, {9.6, 0, 12.8}, 0.1 * d), 0);
  EXPECT_LT(fluid->report().speed_max_m_s, 1);
}
TEST(SettledDam, KeepsItsHeight) { settled_dam_keeps_its_height(sim::Backend::Cpu); }
TEST(SettledDamGpu, KeepsItsHeight) { settled_dam_keeps_its_height(sim::Backend::Cuda); }

}  // namespace
