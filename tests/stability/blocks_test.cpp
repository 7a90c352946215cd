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

/// Two particles alone have too low a density to push each other. In the water, their neighbours pressed such
/// pairs into one place.
void a_close_pair_parts(Backend backend) {
  const float h = 2 * 0.15f;
  const auto pair = start_in_a_cube(
      backend, {{0, 0, 0.5f, 1.5f, 1, 0, 0, 0}, {1, 0, 0.5f + 6e-5f * h, 1.5f + 8e-5f * h, 1, 0, 0, 0}});
  const auto offset = [&] {
    const auto state = pair->read_state();
    EXPECT_NEAR(state[0].x_m + state[1].x_m, 1 + 6e-5f * h, 4e-5);
    return std::hypot(state[1].x_m - state[0].x_m, state[1].y_m - state[0].y_m);
  };
  EXPECT_NEAR(offset(), 1e-4f * h, 1e-6);
  for (int frame = 0; frame < 10; ++frame) pair->step_frame();
  EXPECT_NEAR(offset(), 1e-3f * h, 5e-5f * h);
  EXPECT_EQ(pair->report().guards.coincident_pairs, 0u);
  // The push adds no velocity but for rounded positions. Otherwise it would part the pair at some 0.02 m/s.
  const auto state = pair->read_state();
  EXPECT_NEAR(state[1].vx_m_s - state[0].vx_m_s, 0, 1e-3);
  EXPECT_NEAR(state[1].vy_m_s - state[0].vy_m_s, 0, 1e-3);
}
TEST(S13FewParticles, AClosePairParts) { a_close_pair_parts(Backend::Cpu); }
TEST(S13FewParticlesGpu, AClosePairParts) { a_close_pair_parts(Backend::Cuda); }

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
