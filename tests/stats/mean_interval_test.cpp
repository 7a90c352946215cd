#include "stats/mean_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(MeanInterval, IsStudentsOfHisOwnData) {
  // Student 1908: additional hours of sleep of ten patients; the interval that R's t.test(sleep) prints.
  const std::vector<double> first{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
  const std::vector<double> second{1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  const auto gain = stats::mean_interval(stats::paired_group_means(second, first, 1));
  EXPECT_EQ(gain.n, 10u);
  EXPECT_NEAR(gain.mean, 1.58, 1e-12);
  EXPECT_NEAR(gain.low, 0.7001142, 5e-8);
  EXPECT_NEAR(gain.high, 2.4598858, 5e-8);
}

TEST(MeanInterval, KnowsNothingOfTooFewValues) {
  const auto none = stats::mean_interval({});
  EXPECT_EQ(none.n, 0u);
  EXPECT_TRUE(std::isnan(none.mean));
  const auto one = stats::mean_interval(std::vector<double>{4});
  EXPECT_EQ(one.mean, 4);
  EXPECT_TRUE(std::isnan(one.low));
  EXPECT_TRUE(std::isnan(one.high));
  const auto same = stats::mean_interval(std::vector<double>{2, 2, 2});
  EXPECT_EQ(same.low, 2);
  EXPECT_EQ(same.high, 2);
}

TEST(MeanInterval, RefusesWhatHasNoMean) {
  EXPECT_THROW(stats::mean_interval(std::vector<double>{1, infinite}), std::invalid_argument);
  EXPECT_THROW(stats::mean_interval(std::vector<double>{1, 2}, 1), std::invalid_argument);
  EXPECT_THROW(stats::mean_interval(std::vector<double>{1, 2}, unknown), std::invalid_argument);
}

TEST(GroupMeans, RepeatsCountAsOne) {
  EXPECT_EQ(stats::group_means(std::vector<double>{1, 3, 10, 20}, 2), (std::vector<double>{2, 15}));
  EXPECT_EQ(stats::group_means(std::vector<double>{1, infinite, unknown, infinite}, 2),
            (std::vector<double>{1}))
      << "equal pictures (inf) and missing cells (NaN) are left out";
  EXPECT_TRUE(stats::group_means({}, 3).empty());
  EXPECT_THROW(stats::group_means(std::vector<double>{1, 2, 3}, 2), std::invalid_argument);
  EXPECT_THROW(stats::group_means(std::vector<double>{1}, 0), std::invalid_argument);
}

TEST(GroupMeans, PairsNeedBothSides) {
  const std::vector<double> a{5, infinite, 7, unknown};
  const std::vector<double> b{1, 2, infinite, 4};
  EXPECT_EQ(stats::paired_group_means(a, b, 4), (std::vector<double>{4}));
  EXPECT_THROW(stats::paired_group_means(a, std::vector<double>{1}, 1), std::invalid_argument);
}

}  // namespace
