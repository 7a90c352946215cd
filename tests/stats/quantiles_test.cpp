#include "stats/quantiles.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace {

TEST(Quantiles, HaveTheirTabulatedValues) {
  EXPECT_NEAR(stats::normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(stats::normal_probability(-1.959963984540054), 0.025, 1e-13);
  // df = 1 is Cauchy: tan(pi (p - 1/2)); df = 2: (2p-1) sqrt(2 / (4p(1-p))).
  EXPECT_NEAR(stats::student_quantile(0.975, 1), 12.706204736432095, 1e-9);
  EXPECT_NEAR(stats::student_quantile(0.975, 2), 4.302652729696142, 1e-10);
}

TEST(SortedQuantile, IsLinearBetweenOrderStatistics) {
  const std::vector<double> values{1, 2, 4, 8};
  EXPECT_EQ(stats::sorted_quantile(values, 0), 1);
  EXPECT_EQ(stats::sorted_quantile(values, 1), 8);
  EXPECT_DOUBLE_EQ(stats::sorted_quantile(values, 0.5), 3);
  EXPECT_DOUBLE_EQ(stats::sorted_quantile(values, 0.9), 6.8);
}

TEST(Quantiles, RefuseImpossibleArguments) {
  EXPECT_THROW(stats::normal_quantile(0), std::invalid_argument);
  EXPECT_THROW(stats::student_quantile(1, 3), std::invalid_argument);
  EXPECT_THROW(stats::student_quantile(0.9, 0), std::invalid_argument);
  EXPECT_THROW(stats::sorted_quantile({}, 0.5), std::invalid_argument);
  EXPECT_THROW(stats::sorted_quantile(std::vector<double>{1}, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

}  // namespace
