/// Phenomena that the paper shows in its scenes must appear: HiRes with 8 n_* particles, n_* = 4k on the CPU
/// and 32k on CUDA.

#include "tests/libsim/phenomena.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace {

using sim::Backend;
using State = std::vector<fluid_test::ParticleState>;

class Run {
 public:
  Run(const char* scene_file, Backend backend) : scene_(sim::read_scene(scene_file)) {
    sim::SimulationOptions options;
    options.backend = backend;
    options.n_star = backend == Backend::Cpu ? 4 * 1024 : 32 * 1024;
    fluid_ = sim::make_simulation(scene_, options);
  }
  const sim::Scene& scene() const { return scene_; }
  double spacing() const { return fluid_->spacing_m(); }
  /// The state after `frame` frames; call it with increasing frames.
  State at(int frame) {
    for (; frame_ < frame; ++frame_) fluid_->step_frame();
    return fluid_->read_state();
  }
  /// Expects a healthy run: water at its density, no particles lost, no guard active.
  void expect_healthy() {
    const auto report = fluid_->report();
    std::printf("frame %d: density error mean %.5f, max %.3f, fastest %.1f m/s, limited %llu\n", frame_,
                report.density_error_mean, report.density_max, report.speed_max_m_s,
                static_cast<unsigned long long>(report.guards.speed_limited));
    EXPECT_LT(report.density_error_mean, 0.002);
    // Overlapping poured layers once made water of Faucet 1.9 times as fast as a fall.
    EXPECT_LT(report.speed_max_m_s, 1.5 * fall_speed());
    EXPECT_LT(report.density_max, 1.05);
    EXPECT_EQ(report.guards.not_finite, 0u);
    EXPECT_EQ(report.guards.neighbours_dropped, 0u);
    EXPECT_EQ(report.guards.nozzle_waited, 0u);
    EXPECT_EQ(report.guards.speed_limited, 0u);
    EXPECT_EQ(fluid_test::outside(fluid_->read_state(), scene_.tank_size_m, 0), 0);
  }

 private:
  double fall_speed() const {
    double height = scene_.water.front().max_m[1], speed = 0;
    for (const auto& nozzle : scene_.nozzles) {
      height = std::max(height, nozzle.position_m[1]);
      speed = std::max(speed, nozzle.speed_m_s);
    }
    return std::sqrt(speed * speed + 2 * scene_.gravity_m_s2.size() * height);
  }

  sim::Scene scene_;
  std::unique_ptr<sim::Simulation> fluid_;
  int frame_ = 0;
};

void liquid_bridge(Backend backend) {
  Run run("data/scenes/single_dam.toml", backend);
  double most = 0;
  for (int frame = 200; frame <= 280 && most < 0.3; frame += 5) {
    const double share =
        phenomena::share_with_cavity(run.at(frame), run.scene().tank_size_m, 0.3, run.spacing(), 4);
    if (share > most) std::printf("frame %d: a cavity in %.0f %% of the slices\n", frame, 100 * share);
    most = std::max(most, share);
  }
  EXPECT_GE(most, 0.3);
  run.expect_healthy();
}
TEST(SingleDamSlow, OverturnsIntoALiquidBridge) { liquid_bridge(Backend::Cpu); }
TEST(SingleDamGpu, OverturnsIntoALiquidBridge) { liquid_bridge(Backend::Cuda); }

void turbulent_ring(Backend backend) {
  Run run("data/scenes/jet_impact.toml", backend);
  const phenomena::Axis axis{7.2, 7.2};
  double most = 0;
  std::vector<double> core;
  for (int frame = 80; frame <= 110; frame += 10) {
    const phenomena::Meridian flow(run.at(frame), axis, 7.2, 4.8, 0.3);
    most = std::max(most, flow.ring(1.75).circulation_m2_s);
    core.push_back(flow.ring(1).core_r_m);
    std::printf("frame %d: circulation up to %.1f m2/s, core at r = %.2f m\n", frame,
                flow.ring(1.75).circulation_m2_s, core.back());
    if (frame == 80) run.expect_healthy();
  }
  EXPECT_GE(most, 40);
  for (std::size_t k = 1; k < core.size(); ++k) EXPECT_GT(core[k], core[k - 1]) << "the core moves outwards";
  EXPECT_NEAR(core.front(), 3, 1);
  EXPECT_GT(core.back(), 4.2);
}
TEST(JetImpactSlow, RollsUpATurbulentRing) { turbulent_ring(Backend::Cpu); }
TEST(JetImpactGpu, RollsUpATurbulentRing) { turbulent_ring(Backend::Cuda); }

/// Height of the tenth highest particle within 2 < r < 4.5 m: a sheet, not a stray drop.
double crown_height(const State& state, phenomena::Axis axis) {
  std::vector<double> heights;
  for (const auto& p : state) {
    const double r = axis.radius(p);
    if (r > 2 && r < 4.5) heights.push_back(static_cast<double>(p.y_m));
  }
  if (heights.size() < 10) return 0;
  std::nth_element(heights.begin(), heights.begin() + 9, heights.end(), std::greater<>());
  return heights[9];
}

/// Radius of the highest ring of water beyond the crown's foot. The walls, 10.5 m away, are left out: when a
/// pulse raises its ripple, the previous ripple is still there and as high (2.33 m both at frame 160).
double ripple_radius(const State& state, phenomena::Axis axis, double spacing) {
  constexpr double width = 0.75;
  const auto depths = phenomena::ring_depths(state, axis, 9, width, spacing);
  const auto highest = std::max_element(depths.begin() + 4, depths.end());
  return (static_cast<double>(highest - depths.begin()) + 0.5) * width;
}

void crown_dry_spot_and_ripples(Backend backend) {
  Run run("data/scenes/faucet.toml", backend);
  const phenomena::Axis axis{10.5, 10.5};
  double crown = 0;
  std::vector<double> ripple;
  for (int frame = 160; frame <= 185; frame += 5) {
    const State state = run.at(frame);
    crown = std::max(crown, crown_height(state, axis));
    if (frame == 170) run.expect_healthy();
    if (frame % 20 == 0) ripple.push_back(ripple_radius(state, axis, run.spacing()));
  }
  const State late = run.at(200);
  ripple.push_back(ripple_radius(late, axis, run.spacing()));
  const double depth = phenomena::disc_depth(late, axis, 2.5, run.spacing());
  std::printf("crown up to %.2f m, depth of the dry spot %.3f m, ripple at r = %.2f, %.2f, %.2f m\n", crown,
              depth, ripple[0], ripple[1], ripple[2]);
  // The sheet is one or two particle spacings thick and breaks into drops by chance. On a GPU, HiRes with
  // n_* = 24k to 40k (8 n_* particles) gave 3.4 to 3.9 m, and 3.6 to 5.3 m without the calming of still
  // water.
  EXPECT_GE(crown, 3.1);
  EXPECT_LE(depth, 0.25);
  EXPECT_GT(ripple[1], ripple[0]);
  EXPECT_GT(ripple[2], ripple[1]);
}
TEST(FaucetSlow, ThrowsACrownBaresTheFloorAndSendsRipples) { crown_dry_spot_and_ripples(Backend::Cpu); }
TEST(FaucetGpu, ThrowsACrownBaresTheFloorAndSendsRipples) { crown_dry_spot_and_ripples(Backend::Cuda); }

}  // namespace
