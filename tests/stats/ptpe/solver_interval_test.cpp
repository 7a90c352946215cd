/// The intervals that go to the solver with a and b.

#include "stats/ptpe/solver_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(SolverBand, ReachesOverTheExponentialAndTheFreeCurve) {
  stats::CurveSpread direct;
  direct.curve = {std::log(24), 0.02};
  direct.var_log_a = 0.0025;
  direct.participants = 16;
  const auto alone = direct.band(10).pointwise;
  EXPECT_EQ(stats::solver_band(direct, stats::Refusal{"none"}, 10), alone);
  stats::FormTest form;
  form.curve.at = {std::log(40), 0, 0};
  form.curve.covariance[0] = 0.0025;
  form.curve.participants = 16;
  const auto both = stats::solver_band(direct, form, 10);
  EXPECT_EQ(both[0], alone[0]);
  EXPECT_EQ(both[1], form.curve.band(10).pointwise[1]);
}

}  // namespace
