/// Hard cases S13 (few particles) and S17 (NaN and infinite values), on the CPU and on CUDA.

#include <limits>

#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

void expect_finite_inside(const std::vector<ParticleState>& state) {
  EXPECT_EQ(fluid_test::outside(state, {2, 2, 2}, 0.1 * d), 0);
  for (const auto& p : state)
    ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.z_m + p.vx_m_s + p.vy_m_s + p.vz_m_s)) << p.id;
}

void none_one_and_two(Backend backend) {
  const auto empty = start_in_a_cube(backend, {});
  empty->step_frame();
  EXPECT_EQ(empty->report().particles, 0);
  EXPECT_TRUE(empty->read_state().empty());
  const auto pair = start_in_a_cube(
      backend, {{0, 0, 0.5f, 1.5f, 1, 0, 0, 0}, {1, 0, 0.5f + 2.02f * 0.15f, 1.5f, 1, 0, 0, 0}});
  for (int frame = 0; frame < 10; ++frame) pair->step_frame();
  const auto state = pair->read_state();
  const double dt = 1.0 / 180;
  for (const auto& p : state)
    EXPECT_NEAR(static_cast<double>(p.y_m), 1.5 - 9.81 * dt * dt * 30 * 31 / 2, 1e-5);
  EXPECT_EQ(state[0].x_m, 0.5f);
}
TEST(S13FewParticles, NoneOneAndTwo) { none_one_and_two(Backend::Cpu); }
TEST(S13FewParticlesGpu, NoneOneAndTwo) { none_one_and_two(Backend::Cuda); }

void nan_is_quarantined(Backend backend) {
  auto particles = block(8, 8, 8, {0, 0, 0});
  particles[100].vx_m_s = std::numeric_limits<float>::quiet_NaN();
  particles[200].y_m = std::numeric_limits<float>::infinity();
  const auto fluid = start_in_a_cube(backend, particles);
  for (int frame = 0; frame < 5; ++frame) fluid->step_frame();
  expect_finite_inside(fluid->read_state());
  EXPECT_EQ(fluid->report().guards.not_finite, 2u);
}
TEST(S17NotANumber, IsQuarantined) { nan_is_quarantined(Backend::Cpu); }
TEST(S17NotANumberGpu, IsQuarantined) { nan_is_quarantined(Backend::Cuda); }

}  // namespace
