/// S9: a jet of 30 m/s, and the number of substeps that follows it.

#include <cmath>
#include <limits>

#include "libsim/solver/substeps.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

constexpr double dt = 1.0 / 60;

void jet_strikes_a_wall(Backend backend) {
  // A bar of 6 m x 1.2 m x 1.2 m, 1 m before a wall, without gravity.
  auto scene = fluid_test::tank({12, 8, 8}, {1, 1, 1});
  scene.gravity_m_s2 = 0;
  constexpr double speed = 30;
  constexpr int length = 40;
  const auto start = block(length, 8, 8, {12 - 1 - length * d, 3.4, 3.4}, speed);
  const auto fluid = start_from(backend, scene, start);
  const auto momentum = [](const std::vector<ParticleState>& state) {
    double sum = 0;
    for (const auto& p : state) sum += static_cast<double>(p.vx_m_s);
    return sum / static_cast<double>(state.size());
  };
  double at_4 = 0, at_11 = 0;
  for (int frame = 1; frame <= 30; ++frame) {
    fluid->step_frame();
    const auto state = fluid->read_state();
    ASSERT_EQ(fluid_test::outside(state, scene.tank_size_m, 0), 0) << "frame " << frame;
    if (frame == 4) at_4 = momentum(state);
    if (frame == 11) at_11 = momentum(state);
    const auto taken = fluid->substeps();
    EXPECT_EQ(taken.taken, taken.wished);
    // v dt <= 0.5 h in each substep of the two frames that the start's speed decides.
    if (frame <= 2) {
      EXPECT_EQ(taken.taken, 4);
    }
  }
  // The wall takes rho A v^2: of the bar's momentum, v^2 / length a second.
  const double flux = (at_4 - at_11) / (7 * dt);
  const double expected = speed * speed / (length * d);
  std::printf("S9: momentum flux on the wall %.3f of rho A v^2, fastest %.1f m/s\n", flux / expected,
              fluid->report().speed_max_m_s);
  EXPECT_NEAR(flux / expected, 1, 0.15);
  EXPECT_EQ(fluid->report().guards.speed_limited, 0u);
}
TEST(S09Jet, TunnelsThroughNothingAndItsFluxIsRight) { jet_strikes_a_wall(Backend::Cpu); }
TEST(S09JetGpu, TunnelsThroughNothingAndItsFluxIsRight) { jet_strikes_a_wall(Backend::Cuda); }

TEST(S09Jet, AFrameGoesByTheFrameBeforeLast) {
  sim::SubstepRule rule({.frame_dt_s = dt, .support_m = 0.3, .courant = 0.5, .least = 2, .most = 8}, 0);
  const auto after = [&](double fastest) {
    rule.frame_ended(fastest);
    return rule.next();
  };
  EXPECT_EQ(rule.next(), 2);
  EXPECT_EQ(after(30), 2);  // frame 1 goes by the start
  EXPECT_EQ(after(0), 4);   // frame 2 by frame 0: 30 / 60 / 0.15 = 3.33
  EXPECT_EQ(after(0), 2);
  EXPECT_EQ(after(90), 2);
  EXPECT_EQ(after(45), 8);
  EXPECT_EQ(rule.wished(), 10);
  EXPECT_EQ(after(9), 5) << "exactly 5 x 0.5 h";
  EXPECT_EQ(after(std::numeric_limits<double>::quiet_NaN()), 2);
  EXPECT_EQ(after(1), 8) << "a speed that is none is looked at closely";
}

TEST(S09Jet, FallingCountsBeforeItIsMeasured) {
  // A frame of 0.25 s: two of them add 4.9 m/s.
  const sim::SubstepRule rule({.frame_dt_s = 0.25,
                               .support_m = 0.3,
                               .courant = 0.5,
                               .acceleration_m_s2 = gravity,
                               .least = 1,
                               .most = 32},
                              0);
  EXPECT_EQ(rule.next(), 9);
}

TEST(S09Jet, TheMostIsReportedWhenItBinds) {
  const auto scene = fluid_test::tank({12, 8, 8}, {1, 1, 1});
  sim::SimulationOptions options;
  options.most_substeps = 3;
  const auto fluid = start_from(Backend::Cpu, scene, block(4, 4, 4, {2, 3, 3}, 60), options);
  EXPECT_EQ(fluid->substeps().taken, 0);
  fluid->step_frame();
  EXPECT_EQ(fluid->substeps().taken, 3);
  EXPECT_EQ(fluid->substeps().wished, 7);
  EXPECT_EQ(fluid->report().substeps.wished, 7);
}

}  // namespace
