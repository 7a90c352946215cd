/// S9: the number of substeps, which follows the fastest particle.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "libsim/solver/substeps.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;

constexpr double dt = 1.0 / 60;

TEST(S09Jet, AFrameGoesByTheFrameBeforeLast) {
  sim::SubstepRule rule({.frame_dt_s = dt, .support_m = 0.3, .courant = 0.5, .least = 2, .most = 8}, 0);
  const auto after = [&](double fastest) {
    rule.frame_ended(fastest);
    return rule.next();
  };
  EXPECT_EQ(rule.next(), 2);
  EXPECT_EQ(after(30), 2);  // frame 1 uses the start's speed
  EXPECT_EQ(after(0), 4);   // frame 2 uses the speed of frame 0: 30 / 60 / 0.15 = 3.33
  EXPECT_EQ(after(0), 2);
  EXPECT_EQ(after(90), 2);
  EXPECT_EQ(after(45), 8);
  EXPECT_EQ(rule.wished(), 10);
  EXPECT_EQ(after(9), 5) << "exactly 5 x 0.5 h";
  EXPECT_EQ(after(std::numeric_limits<double>::quiet_NaN()), 2);
  EXPECT_EQ(after(1), 8) << "a speed that is none is looked at closely";
}

TEST(S09Jet, FallingCountsBeforeItIsMeasured) {
  // A fall of two frames of 0.25 s adds 4.9 m/s, which the rule must expect before it is measured.
  const sim::SubstepRule rule({.frame_dt_s = 0.25,
                               .support_m = 0.3,
                               .courant = 0.5,
                               .acceleration_m_s2 = gravity,
                               .least = 1,
                               .most = 32},
                              0);
  EXPECT_EQ(rule.next(), 9);
}

TEST(S09Jet, StrongGravityCountsWhereWaterRests) {
  const auto steps = [](double acceleration) {
    return sim::SubstepRule({.frame_dt_s = 1.0 / 60,
                             .support_m = 0.3,
                             .courant = 0.5,
                             .acceleration_m_s2 = acceleration,
                             .least = 2,
                             .most = 32},
                            0)
        .next();
  };
  EXPECT_EQ(steps(gravity), 2);
  // A substep of sqrt(0.04 h / g) needs sqrt(1000 / (0.04 * 0.3)) / 60 = 4.8 substeps a frame; the
  // displacement of the fastest particle alone would need 3.7.
  EXPECT_EQ(steps(1000), 5);
}

/// The bounds that case S1 (a tank at rest) sets for the density, in a pool of 13 layers. Under 1000 m/s2 the
/// pool settles to 0.96 of its height, as under the earth's gravity. With only the scene's two substeps a
/// frame it settled to 0.90.
TEST(S09Jet, APoolUnderStrongGravityKeepsItsDensityAndHeight) {
  for (const double strength : {160.0, 1000.0}) {
    auto scene = fluid_test::tank({0.8, 1.6, 0.8}, {0.8, 0.8, 0.8}, 20);
    scene.viscosity_m2_s = 0.001;
    scene.gravity_m_s2 = strength;
    sim::SimulationOptions options;
    options.n_star = 256;
    const auto fluid = sim::make_simulation(scene, options);
    EXPECT_GT(fluid_test::centre_height(fluid->read_state()) / 0.4, 0.94) << strength;
    for (int frame = 1; frame <= 20; ++frame) {
      fluid->step_frame();
      const auto report = fluid->report();
      EXPECT_LT(report.density_error_mean, 0.01) << strength;
      EXPECT_LT(report.density_max, 1.08) << strength;
    }
    EXPECT_FALSE(fluid->divergence()) << strength;
  }
}

/// Forces that compress even water at rest within the most substeps of a frame are refused, unless
/// substeps or the frame's duration were given.
TEST(S09Jet, ForcesBeyondTheMostSubstepsAreRefused) {
  auto scene = fluid_test::tank({0.8, 1.6, 0.8}, {0.8, 0.8, 0.8}, 0);
  scene.gravity_m_s2 = 900;
  scene.frame_dt_s = 0.1;
  sim::SimulationOptions options;
  options.n_star = 256;
  // d = 0.063 m, h = 0.126 m: 0.1 s sqrt(900 / (0.04 h)) = 42.2 substeps, and at most 32 at 14 frames/s.
  const auto error = [&] {
    try {
      sim::make_simulation(scene, options);
    } catch (const base::Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error(), testing::AllOf(testing::HasSubstr("gravity_m_s2"), testing::HasSubstr("43 substeps"),
                                      testing::HasSubstr("raise frames_per_s to 14"),
                                      testing::HasSubstr("set min_substeps to 43")));
  scene.min_substeps = 43;
  EXPECT_EQ(error(), "");
  scene.min_substeps = 2;
  scene.frame_dt_s = 1.0 / 14;
  EXPECT_EQ(error(), "");
  scene.frame_dt_s = 0.1;
  options.substeps = 8;
  EXPECT_EQ(error(), "");
  options.substeps = 0;
  options.frame_dt_s = 0.1;
  EXPECT_EQ(error(), "");
  options.frame_dt_s = 0;
  scene.gravity_m_s2 = 0;
  scene.central_force = sim::CentralForce{.omega_per_s = 100, .centre_m = {0.4, 0, 0.4}, .axis = {0, 1, 0}};
  EXPECT_THAT(error(),
              testing::AllOf(testing::HasSubstr("central_force"), testing::HasSubstr("omega_per_s")));
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
