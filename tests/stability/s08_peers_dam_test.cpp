/// Peers' dam at a million particles: walls, lists and speeds at CFL 1.5 (S8, S14), every frame measured.

#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

struct Dam {
  double densest = 0, fastest = 0;
  int short_frames = 0;
  sim::FrameReport last;
};

Dam break_dam(Backend backend, std::int64_t n_star, int frames) {
  sim::SimulationOptions options;
  options.n_star = n_star;
  options.backend = backend;
  const auto fluid = sim::make_simulation(sim::read_scene("data/scenes/peers_dam.toml"), options);
  Dam out;
  double error = 0;
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    out.last = fluid->report();
    out.densest = std::max(out.densest, out.last.density_max);
    out.fastest = std::max(out.fastest, out.last.speed_max_m_s);
    out.short_frames += out.last.substeps.wished > out.last.substeps.taken;
    error += out.last.density_error_mean / frames;
  }
  std::printf("PeersDam, %lld particles, %d frames: max rho %.3f, mean error %.5f, fastest %.1f m/s\n",
              static_cast<long long>(out.last.particles), frames, out.densest, error, out.fastest);
  return out;
}

void dam_is_sound(Backend backend, std::int64_t n_star, int frames) {
  const Dam dam = break_dam(backend, n_star, frames);
  EXPECT_LT(dam.densest, 1.2);
  EXPECT_EQ(dam.short_frames, 0);
  EXPECT_EQ(dam.last.guards.neighbours_dropped, 0u);
  EXPECT_EQ(dam.last.guards.coincident_pairs, 0u);
  EXPECT_EQ(dam.last.guards.speed_limited, 0u);
  EXPECT_EQ(dam.last.guards.not_finite, 0u);
}
TEST(S08PeersDam, NobodyIsBrakedDroppedOrCrushed) { dam_is_sound(Backend::Cpu, 1024, 100); }
TEST(S08PeersDamGpu, NobodyIsBrakedDroppedOrCrushedAtAMillion) {
  dam_is_sound(Backend::Cuda, 128 * 1024, 240);
}

}  // namespace
