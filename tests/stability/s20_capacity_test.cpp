/// S20: no room for more particles, on the CPU and on CUDA.

#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;

void capacity_refuses_gracefully(Backend backend) {
  // S20: room for 1,000 particles, water for 2,304.
  const Settled tank(backend);
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = tank.state;
  const auto coarse = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 100; ++frame) coarse->step_frame();
  options.start = coarse->read_state();
  std::int64_t next = 0;
  for (auto& p : *options.start) p.id = static_cast<int>(next++);
  options.particle_capacity = 1000;
  options.forced_targets = everywhere(0);
  const auto fluid = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 120; ++frame) fluid->step_frame();
  const auto full = fluid->report();
  EXPECT_EQ(fluid->particle_capacity(), 1000);
  EXPECT_GT(full.levels.split_no_room, 0u);
  EXPECT_GT(full.particles, 990);
  for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->report().levels.splits, full.levels.splits) << "it goes on splitting without room";
  EXPECT_EQ(fluid->report().levels.merges, 0u);
  expect_sound(*fluid, next, 8 * Settled::n_star);
}
TEST(S20Capacity, RefusesGracefully) { capacity_refuses_gracefully(Backend::Cpu); }
TEST(S20CapacityGpu, RefusesGracefully) { capacity_refuses_gracefully(Backend::Cuda); }

}  // namespace
