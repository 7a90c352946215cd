/// The intervals that the solver receives with a and b of the threshold curve mu = a exp(b delta).

#include "stats/ptpe/solver_interval.hpp"

#include <gtest/gtest.h>

#include <array>

namespace {

using Interval = std::array<double, 2>;

TEST(SolverInterval, ReachesOverBothEstimators) {
  stats::CurveSpread direct;
  direct.a_ci = {20, 26};
  direct.b_ci = {0.01, 0.03};
  const auto open =
      stats::solver_interval(direct, stats::PilotSpread{.a_ci = {18, 25}, .b_ci = {0.02, 0.04}});
  EXPECT_EQ(open.a_ci, (Interval{18, 26}));
  EXPECT_EQ(open.b_ci, (Interval{0.01, 0.04}));
  EXPECT_TRUE(open.spans_contour);
}

TEST(SolverInterval, IsTheDirectOneWhereTheContourHasNone) {
  stats::CurveSpread direct;
  direct.a_ci = {20, 26};
  direct.b_ci = {0.01, 0.03};
  const auto open = stats::solver_interval(direct, stats::Refusal{"no contour"});
  EXPECT_EQ(open.a_ci, direct.a_ci);
  EXPECT_EQ(open.b_ci, direct.b_ci);
  EXPECT_FALSE(open.spans_contour);
}

}  // namespace
