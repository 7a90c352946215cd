#include "stats/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace {

TEST(ResampleWeights, AreEqualOnEveryMachine) {
  // The weights must not change, so that an interval in a paper can be reproduced.
  EXPECT_EQ(stats::resample_weights(6, 1, 0), (std::vector<double>{0, 0, 2, 0, 2, 2}));
  EXPECT_EQ(stats::resample_weights(6, 1, 1), (std::vector<double>{0, 1, 3, 2, 0, 0}));
}

TEST(ResampleWeights, DrawEachUnitAlikeAndIndependently) {
  constexpr int n = 16, resamples = 20000;
  std::vector<double> sums(n, 0.0);
  double squares = 0;
  for (int i = 0; i < resamples; ++i) {
    const auto weights = stats::resample_weights(n, 5, static_cast<std::uint64_t>(i));
    ASSERT_EQ(std::accumulate(weights.begin(), weights.end(), 0.0), n);
    for (int unit = 0; unit < n; ++unit) {
      sums[unit] += weights[unit];
      squares += (weights[unit] - 1) * (weights[unit] - 1);
    }
  }
  // A count is Binomial(n, 1/n): mean 1, variance 1 - 1/n. The bounds of the means are five standard errors.
  const double variance = 1 - 1.0 / n;
  for (const double sum : sums) EXPECT_NEAR(sum / resamples, 1, 5 * std::sqrt(variance / resamples));
  EXPECT_NEAR(squares / (n * resamples), variance, 0.02);
}

TEST(ExpandedPercentile, CoversTheMeanOfFewNormalsAsTDoes) {
  // The resampled means of n values with the variance s are nearly normal with the variance (n - 1) / n s /
  // n. So the expanded interval is about mean -+ t sqrt(s / n), where t has n - 1 degrees of freedom.
  constexpr int n = 8;
  const std::vector<double> x{3.1, -0.4, 1.7, 2.2, 0.3, 1.1, 4.0, 2.6};
  std::vector<double> means;
  for (int i = 0; i < 40000; ++i) {
    const auto w = stats::resample_weights(n, 9, static_cast<std::uint64_t>(i));
    means.push_back(std::inner_product(x.begin(), x.end(), w.begin(), 0.0) / n);
  }
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  double s = 0;
  for (const double xi : x) s += (xi - mean) * (xi - mean) / (n - 1);
  const double half = 2.364624251592785 * std::sqrt(s / n);
  const auto interval = stats::expanded_percentile_interval(means, n, 0.95);
  EXPECT_NEAR(interval[0], mean - half, 0.06 * half);
  EXPECT_NEAR(interval[1], mean + half, 0.06 * half);
  EXPECT_NEAR(stats::bootstrap_se(means), std::sqrt((n - 1.0) / n * s / n), 0.01 * half);
}

TEST(ExpandedPercentile, TendsToThePlainPercentileWithManyUnits) {
  EXPECT_NEAR(stats::expanded_tail(100000, 0.95), 0.025, 1e-5);
  EXPECT_LT(stats::expanded_tail(16, 0.95), 0.015);
  EXPECT_THROW(stats::expanded_tail(1, 0.95), std::invalid_argument);
}

}  // namespace
