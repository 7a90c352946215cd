#include "stats/fps_window.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace {

TEST(FpsMoments, FollowTheirDefinitions) {
  // The rates are 10, 20, 40 frames/s: mean 70/3, harmonic mean 3/0.175, population standard deviation
  // sqrt(1400/9).
  const std::vector<double> intervals{0.1, 0.05, 0.025};
  const auto moments = stats::fps_moments(intervals);
  EXPECT_EQ(moments.frames, 3u);
  EXPECT_NEAR(moments.mean, 3 / 0.175, 1e-12);
  EXPECT_NEAR(moments.mean_arithmetic, 70.0 / 3, 1e-12);
  EXPECT_NEAR(moments.sd, 12.472191289246471, 1e-12);
}

TEST(FpsMoments, ConstantIntervalsHaveNoSpread) {
  EXPECT_NEAR(stats::fps_moments(std::vector<double>(300, 1.0 / 30)).sd, 0, 1e-12);
}

TEST(FpsMoments, RefusesIntervalsThatAreNoTime) {
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(stats::fps_moments(std::vector<double>{0.1, bad}), std::invalid_argument);
  }
}

TEST(FpsWindow, KeepsTheLastFramesOnly) {
  stats::FpsWindow window(2);
  for (const double dt : {1.0, 0.1, 0.05}) window.push(dt);
  EXPECT_EQ(window.moments().frames, 2u);
  EXPECT_NEAR(window.moments().mean, 2 / 0.15, 1e-12);
}

}  // namespace
