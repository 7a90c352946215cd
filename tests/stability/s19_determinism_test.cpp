/// S19: order, threads and reports change no bit, on the CPU and on CUDA; the two agree.

#include <omp.h>

#include <random>

#include "tests/libsim/levels_helpers.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

void order_does_not_matter(Backend backend) {
  auto particles = block(8, 8, 8, {0, 0, 0});
  const auto a = start_in_a_cube(backend, particles);
  std::shuffle(particles.begin(), particles.end(), std::mt19937(4));
  const auto b = start_in_a_cube(backend, particles);
  const auto c = start_in_a_cube(backend, particles);
  for (int frame = 0; frame < 20; ++frame) {
    a->step_frame();
    b->step_frame();
    c->step_frame();
    if (frame == 10) c->report();  // reading must not change the run
  }
  EXPECT_TRUE(same(a->read_state(), b->read_state()));
  EXPECT_TRUE(same(b->read_state(), c->read_state()));
}
TEST(S19Determinism, ShuffledInputAndReportsChangeNoBit) { order_does_not_matter(Backend::Cpu); }
TEST(S19DeterminismGpu, ShuffledInputAndReportsChangeNoBit) { order_does_not_matter(Backend::Cuda); }

TEST(S19Determinism, ThreadCountChangesNoBit) {
  std::vector<std::vector<ParticleState>> ends;
  const int threads = omp_get_max_threads();
  for (const int count : {1, 2, 5}) {
    omp_set_num_threads(count);
    const auto fluid = start_in_a_cube(Backend::Cpu, block(12, 12, 12, {0, 0, 0}));
    for (int frame = 0; frame < 10; ++frame) fluid->step_frame();
    ends.push_back(fluid->read_state());
  }
  omp_set_num_threads(threads);
  EXPECT_TRUE(same(ends[0], ends[1]));
  EXPECT_TRUE(same(ends[0], ends[2]));
}

TEST(S19BackendParityGpu, PositionsAgreeAfterFiftySteps) {
  // Starts from a settled state: a perfect lattice is an unstable equilibrium that amplifies the last bit.
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  sim::SimulationOptions options;
  options.n_star = 1024;
  options.substeps = 2;
  options.start = sim::make_simulation(scene, options)->read_state();
  const auto cpu = sim::make_simulation(scene, options);
  options.backend = Backend::Cuda;
  const auto cuda = sim::make_simulation(scene, options);
  double rms = 0;
  for (int step = 2; step <= 50; step += 2) {
    cpu->step_frame();
    cuda->step_frame();
    const auto a = cpu->read_state();
    const auto b = cuda->read_state();
    ASSERT_EQ(a.size(), b.size());
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      squares += std::pow(static_cast<double>(a[i].x_m - b[i].x_m), 2) +
                 std::pow(static_cast<double>(a[i].y_m - b[i].y_m), 2) +
                 std::pow(static_cast<double>(a[i].z_m - b[i].z_m), 2);
    }
    rms = std::sqrt(squares / static_cast<double>(a.size())) / cpu->spacing_m();
    if (step % 10 == 0)
      std::printf("back-end parity: %.2e d RMS after %d steps of %zu particles\n", rms, step, a.size());
  }
  EXPECT_LT(rms, 1e-3);
}

void levels_keep_their_bits(Backend backend) {
  const levels_test::Settled tank(backend);
  auto shuffled = tank.state;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(4));
  const sim::TargetRegion region{{6 * d, 8 * d, 6 * d}, 5 * d, 0, 3};
  std::vector<std::vector<ParticleState>> ends;
  for (const int threads : {1, 2, 5}) {
    auto options = levels_test::options_for(backend, levels_test::Settled::n_star, region);
    options.start = threads == 2 ? shuffled : tank.state;
    const int usual = omp_get_max_threads();
    omp_set_num_threads(threads);
    const auto fluid = sim::make_simulation(tank.scene, options);
    for (int frame = 0; frame < 25; ++frame) {
      fluid->step_frame();
      if (threads == 5 && frame == 11) fluid->report();
      if (frame == 15) fluid->force_targets(levels_test::everywhere(0));
    }
    omp_set_num_threads(usual);
    ends.push_back(fluid->read_state());
  }
  EXPECT_TRUE(same(ends[0], ends[1])) << "the input's order matters";
  EXPECT_TRUE(same(ends[0], ends[2])) << "threads or a report matter";
}
TEST(S19Determinism, LevelsOrderThreadsAndReportsChangeNoBit) { levels_keep_their_bits(Backend::Cpu); }
TEST(S19DeterminismGpu, LevelsOrderAndReportsChangeNoBit) { levels_keep_their_bits(Backend::Cuda); }

}  // namespace
