#include "stats/inference/distributions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace {

using namespace stats;

void expect_relative(double got, double want, double rtol, const char* what) {
  EXPECT_NEAR(got, want, rtol * std::abs(want)) << what;
}

TEST(Student, ClosedFormsOfSmallDegreesOfFreedom) {
  for (const double t : {1e-8, 0.3, 1.0, 2.5, 40.0, 1e6}) {
    expect_relative(student_upper(t, 1), std::atan2(1, t) / std::numbers::pi, 1e-14, "Cauchy");
    // (1 - t / sqrt(2 + t^2)) / 2, rewritten without cancellation.
    const double root = std::sqrt(2 + t * t);
    expect_relative(student_upper(t, 2), 1 / (root * (root + t)), 1e-14, "df 2");
    expect_relative(student_lower(-t, 2), student_upper(t, 2), 0, "mirror");
  }
}

TEST(Student, FarTailsAgainstFiftyDigits) {
  // Regularised incomplete beta function in 50-digit arithmetic (mpmath 1.3).
  expect_relative(student_upper(5, 39), 6.26208704468361112e-06, 1e-12, "t 5");
  expect_relative(student_upper(1011.1847445749939, 39), 4.36163166063400724e-88, 1e-12, "t 1011");
  expect_relative(student_upper(3, 1e4), 0.0013532240949988344, 1e-11, "df 1e4");
  expect_relative(student_upper(3, 6e4), 0.0013504520731574552, 1e-12, "df 6e4");
  expect_relative(student_upper(30, 1e5), 3.6892684361111168e-197, 1e-11, "df 1e5");
}

TEST(Student, QuantileInvertsTheTail) {
  for (const double df : {0.5, 1.0, 2.7, 25.0, 1e4, 1e7}) {
    for (const double p : {1e-30, 1e-6, 0.025, 0.4, 0.5, 0.8}) {
      const double t = student_upper_quantile(p, df);
      if (p < 0.5) expect_relative(student_upper(t, df), p, 1e-11, "tail");
      if (p >= 0.025) {
        EXPECT_NEAR(t, -student_upper_quantile(1 - p, df), 1e-13 * std::abs(t)) << "mirror";
      }
    }
  }
  EXPECT_NEAR(student_upper_quantile(0.025, 1), 12.706204736174694, 1e-12);
}

TEST(NoncentralT, AgainstThirtyDigits) {
  // Integral over the chi variate by mpmath 1.3 at 30 digits.
  expect_relative(noncentral_t_lower(2, 10, 1), 0.80761156253037527, 1e-13, "2 10 1");
  expect_relative(noncentral_t_upper(2, 10, -3), 2.3181592899834628e-06, 1e-12, "2 10 -3");
  expect_relative(noncentral_t_lower(-2, 5, 3), 7.7996360918320379e-06, 1e-12, "-2 5 3");
  expect_relative(noncentral_t_upper(100, 4, 55), 0.12366876016323232, 1e-13, "100 4 55");
  expect_relative(noncentral_t_upper(100, 4, 65), 0.20756173007828857, 1e-13, "100 4 65");
}

TEST(NoncentralT, JoinsItsLimits) {
  for (const double df : {1.0, 3.5, 40.0}) {
    expect_relative(noncentral_t_upper(1.7, df, 0), student_upper(1.7, df), 1e-12, "central");
    expect_relative(noncentral_t_lower(0, df, 1.3), std::erfc(1.3 / std::numbers::sqrt2) / 2, 1e-13, "t = 0");
    const double below = noncentral_t_upper(70, df, 60), above = noncentral_t_upper(70, df, 60.0000001);
    EXPECT_NEAR(above, below, 1e-7) << "both methods agree where they meet";
    EXPECT_NEAR(noncentral_t_lower(2, df, 1) + noncentral_t_upper(2, df, 1), 1, 1e-13);
  }
  EXPECT_EQ(noncentral_t_lower(-3, 5, 100), 0);
  EXPECT_EQ(noncentral_t_upper(-3, 5, 100), 1);
}

TEST(NoncentralT, IntervalHasTheTailsItSays) {
  for (const double t : {0.0, 0.7, -3.0, 40.0, 1e4}) {
    for (const double df : {1.0, 2.0, 25.0, 1e4}) {
      const auto ci = noncentrality_interval(t, df, 0.9);
      EXPECT_LT(ci[0], ci[1]);
      EXPECT_NEAR(noncentral_t_upper(t, df, ci[0]), 0.05, 1e-10) << t << " " << df;
      EXPECT_NEAR(noncentral_t_lower(t, df, ci[1]), 0.05, 1e-10) << t << " " << df;
    }
  }
}

TEST(HedgesFactor, IsExact) {
  EXPECT_NEAR(hedges_factor(2), 1 / std::sqrt(std::numbers::pi), 1e-15);
  EXPECT_NEAR(hedges_factor(4), std::sqrt(2 / std::numbers::pi), 1e-15);
  EXPECT_NEAR(hedges_factor(1e8), 1 - 0.75e-8, 1e-15);
}

TEST(Fisher, SquareOfT) {
  for (const double t : {0.1, 1.0, 3.0, 30.0})
    expect_relative(fisher_upper(t * t, 1, 17), 2 * student_upper(t, 17), 1e-12, "F(1, df) = t^2");
  EXPECT_EQ(fisher_upper(0, 3, 4), 1);
}

TEST(Distributions, RejectWhatIsNotDefined) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(student_upper(1, 0), std::invalid_argument);
  EXPECT_THROW(student_upper(nan, 3), std::invalid_argument);
  EXPECT_THROW(student_upper_quantile(0, 3), std::invalid_argument);
  EXPECT_THROW(noncentral_t_lower(1, nan, 0), std::invalid_argument);
  EXPECT_THROW(noncentrality_interval(nan, 3), std::invalid_argument);
  EXPECT_THROW(hedges_factor(1), std::invalid_argument);
  EXPECT_THROW(fisher_upper(-1, 2, 3), std::invalid_argument);
}

}  // namespace
