/// Merges in water at rest (S5 and coarsening), on the CPU and on CUDA.

#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;

void tank_coarsens(Backend backend) {
  const Settled tank(backend);
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = tank.state;
  const auto fluid = sim::make_simulation(tank.scene, options);
  double densest = 0;
  double jumps = 0;
  int reached = -1;
  for (int frame = 1; frame <= 120; ++frame) {
    fluid->step_frame();
    const auto report = fluid->report();
    densest = std::max(densest, report.density_max);
    jumps = std::max(jumps, report.jump_share);
    if (reached < 0 && share_at(report, 3) >= 0.9) reached = frame;
    if (frame % 20 == 0) {
      std::printf(
          "coarsening, frame %d: %lld particles, mass at levels %.3f %.3f %.3f %.3f, max rho %.3f, jumps "
          "%.4f\n",
          frame, static_cast<long long>(report.particles), share_at(report, 0), share_at(report, 1),
          share_at(report, 2), share_at(report, 3), report.density_max, report.jump_share);
    }
  }
  const auto last = fluid->report();
  std::printf(
      "coarsening: 90 %% of the mass at level 3 in frame %d, max rho %.3f, largest share of jumps %.4f, "
      "refused: overlap %llu, step %llu\n",
      reached, densest, jumps, static_cast<unsigned long long>(last.levels.merge_overlap),
      static_cast<unsigned long long>(last.levels.merge_step));
  EXPECT_GE(share_at(last, 3), 0.9);
  EXPECT_LT(densest, 1.25);
  expect_sound(*fluid, 8 * Settled::n_star, 8 * Settled::n_star);
  EXPECT_EQ(fluid_test::outside(fluid->read_state(), tank.scene.tank_size_m, 0.1 * d), 0);
}
TEST(S05Merges, UniformTankCoarsens) { tank_coarsens(Backend::Cpu); }
TEST(S05MergesGpu, UniformTankCoarsens) { tank_coarsens(Backend::Cuda); }

void square_wave_does_not_oscillate(Backend backend) {
  // S5: targets that change every 1, 2 and 3 frames never cause a merge.
  const Settled tank(backend);
  auto start = tank.state;
  for (const int half : {1, 2, 3}) {
    auto options = options_for(backend, Settled::n_star, everywhere(0));
    options.start = start;
    const auto fluid = sim::make_simulation(tank.scene, options);
    for (int frame = 0; frame < 36; ++frame) {
      fluid->force_targets(everywhere(frame / half % 2 ? 0 : 3));
      fluid->step_frame();
    }
    EXPECT_EQ(fluid->report().levels.merges, 0u) << "period " << 2 * half;
    EXPECT_EQ(fluid->particle_count(), 8 * Settled::n_star);
  }
  // Coarse particles split once, then nothing changes.
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = start;
  auto fluid = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
  options.start = fluid->read_state();
  fluid = sim::make_simulation(tank.scene, options);
  std::int64_t settled = 0;
  // The last particles to split lie beside a wall, and wait until they have room.
  for (int frame = 0; frame < 300; ++frame) {
    fluid->force_targets(everywhere(frame / 2 % 2 ? 0 : 3));
    fluid->step_frame();
    if (frame == 260) settled = fluid->particle_count();
  }
  EXPECT_EQ(fluid->report().levels.merges, 0u);
  EXPECT_GT(fluid->report().levels.splits, 0u);
  EXPECT_EQ(fluid->particle_count(), settled);
}
TEST(S05Merges, SquareWaveDoesNotOscillate) { square_wave_does_not_oscillate(Backend::Cpu); }
TEST(S05MergesGpu, SquareWaveDoesNotOscillate) { square_wave_does_not_oscillate(Backend::Cuda); }

}  // namespace
