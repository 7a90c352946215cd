#include "libsim/ptpe/tolerance_switch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "stats/base/error.hpp"

namespace {

using sim::ToleranceSwitch;

TEST(ToleranceSwitch, BetaIsThePapersAndNeverAboveOne) {
  EXPECT_NEAR(ToleranceSwitch({}, -1).beta(), 0.9608, 5e-5);
  EXPECT_NEAR(ToleranceSwitch({}, -10).beta(), 0.6703, 5e-5);
  EXPECT_EQ(ToleranceSwitch({}, 0).beta(), 1);
  EXPECT_EQ(ToleranceSwitch({}, 12).beta(), 1);
  EXPECT_EQ(ToleranceSwitch({24, -0.01}, -10).beta(), 1) << "a fit may give a negative b";
  EXPECT_THROW(ToleranceSwitch({}, std::nan("")), base::Error);
}

/// Feeds a full window of one frame rate: delta = 0, so that tau = rate - 23.68.
void feed(ToleranceSwitch& s, double frames_per_second) {
  for (std::size_t i = 0; i < ToleranceSwitch::window_frames; ++i) s.frame_time(1000 / frames_per_second);
}

TEST(ToleranceSwitch, GoesOnBelowZeroAndOffAboveOne) {
  ToleranceSwitch s;
  feed(s, 23.68 + 0.5);
  EXPECT_FALSE(s.on()) << "between the thresholds it stays as it was";
  feed(s, 23.68 - 0.5);
  EXPECT_TRUE(s.on());
  EXPECT_NEAR(s.tau().value(), -0.5, 1e-9);
  EXPECT_NEAR(s.beta(), std::exp(2 * 0.02 * -0.5), 1e-9);
  feed(s, 23.68 + 0.5);
  EXPECT_TRUE(s.on());
  EXPECT_EQ(s.beta(), 1) << "tau is clamped to at most 0";
  feed(s, 23.68 + 1.5);
  EXPECT_FALSE(s.on());
}

// For intervals of 10 and 90 ms the harmonic mean is 20 frames/s, the arithmetic one 55.6.
TEST(ToleranceSwitch, HonoursTheMeanOfTheModel) {
  for (const auto& [mean, expected] :
       {std::pair{stats::FpsMean::Harmonic, 20.0}, std::pair{stats::FpsMean::Arithmetic, 500.0 / 9}}) {
    sim::ToleranceSwitch tolerance({23.68, 0, mean});
    for (int frame = 0; frame < 30; ++frame) tolerance.frame_time(frame % 2 ? 90 : 10);
    EXPECT_NEAR(tolerance.rate()->mean, expected, 1e-9);
    EXPECT_NEAR(*tolerance.tau(), expected - 23.68, 1e-9);
  }
}

TEST(ToleranceSwitch, WaitsForAFullWindowAndForgetsOlderFrames) {
  ToleranceSwitch s;
  for (std::size_t i = 1; i < ToleranceSwitch::window_frames; ++i) s.frame_time(100);
  EXPECT_FALSE(s.on());
  EXPECT_NEAR(s.tau().value(), 10 - 23.68, 1e-9);
  s.frame_time(100);
  EXPECT_TRUE(s.on());
  feed(s, 60);
  EXPECT_NEAR(s.tau().value(), 60 - 23.68, 1e-9);
  EXPECT_FALSE(s.on());
}

TEST(ToleranceSwitch, TauFallsWithTheScatterOfTheRate) {
  ToleranceSwitch s;
  // 25 and 50 frames/s in turn: mu = 2 / (0.04 + 0.02) = 33.3, delta = 12.5.
  for (std::size_t i = 0; i < ToleranceSwitch::window_frames; ++i) s.frame_time(i % 2 ? 40 : 20);
  EXPECT_NEAR(s.tau().value(), 100.0 / 3 - 23.68 * std::exp(0.02 * 12.5), 1e-9);
}

TEST(ToleranceSwitch, CountsTimesThatAreNone) {
  ToleranceSwitch s;
  for (const double ms : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) s.frame_time(ms);
  EXPECT_EQ(s.left_out(), 4u);
  EXPECT_FALSE(s.tau());
}

TEST(ParseTau, ReadsLiveAndFixedValuesOnly) {
  EXPECT_FALSE(sim::parse_tau("live").has_value());
  EXPECT_EQ(sim::parse_tau("fixed:-6.5").value(), -6.5);
  for (const char* text : {"", "Live", "-6", "fixed:", "fixed:x", "fixed:1x", "fixed:nan", "fixed:inf"}) {
    EXPECT_THROW(sim::parse_tau(text), base::Error) << text;
  }
}

TEST(ToleranceSwitch, AFixedTauIgnoresTheClock) {
  ToleranceSwitch s({}, -6);
  feed(s, 90);
  EXPECT_EQ(s.tau(), -6);
  EXPECT_TRUE(s.on());
}

}  // namespace
