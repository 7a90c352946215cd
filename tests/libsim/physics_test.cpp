/// Water at rest keeps its place.

#include <gtest/gtest.h>

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;

struct RestResult {
  double drift = 0, density_mean = 0, density_max = 0, rms = 0, loss = 0;
  int out = 0;
};

RestResult rest(const sim::Scene& scene, const sim::SimulationOptions& options, int frames) {
  const auto fluid = sim::make_simulation(scene, options);
  const double filled = fluid_test::centre_height(fluid->read_state());
  RestResult result;
  double half = 0;
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    if (frame == frames / 2) half = fluid_test::centre_height(fluid->read_state());
    if (frame >= frames / 2 && frame % 20 == 0)
      result.density_max = std::max(result.density_max, fluid->report().density_max);
  }
  const auto state = fluid->read_state();
  result.density_mean = fluid->report().density_error_mean;
  result.drift = std::abs(fluid_test::centre_height(state) - half) / half;
  result.loss = 1 - fluid_test::centre_height(state) / filled;
  result.rms = fluid_test::rms_speed(state);
  result.out = fluid_test::outside(state, scene.tank_size_m, 0.1 * fluid->spacing_m());
  std::printf(
      "rest: density error mean %.5f, max %.4f, centre of mass loss %.4f, drift %.5f, v_rms %.4f m/s\n",
      result.density_mean, result.density_max, result.loss, result.drift, result.rms);
  return result;
}

void tank_stays_at_rest(sim::Backend backend) {
  // S1: 20 layers for 10 s. n_* = 400 -> 3,200 particles, d = cbrt(V / 3200).
  const double d = 0.15;
  const auto scene = fluid_test::tank({16 * d, 40 * d, 10 * d}, {16 * d, 20 * d, 10 * d});
  sim::SimulationOptions options;
  options.n_star = 400;
  options.backend = backend;
  const auto result = rest(scene, options, 600);
  EXPECT_LT(result.density_mean, 0.01);
  EXPECT_LT(result.density_max, 1.08);
  EXPECT_LT(result.drift, 0.005);
  EXPECT_LT(result.rms, 0.02 * std::sqrt(9.81 * 20 * d));
  EXPECT_EQ(result.out, 0);
}
TEST(RestTank, StaysAtRest) { tank_stays_at_rest(sim::Backend::Cpu); }
TEST(RestTankGpu, StaysAtRest) { tank_stays_at_rest(sim::Backend::Cuda); }

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
  // 98 % of the block's height lie below the 98th percentile of a block that has kept it.
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
