#include "stats/inference/reliability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "stats/base/file.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using namespace stats;
using Values = std::vector<double>;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Two items: alpha is 4 times their covariance over the variance of their sum.
TEST(CronbachAlpha, OfTwoItemsByHand) {
  // Items 1 2 3 and 2 2 5: variances 1 and 3, covariance 3/2; their sums 3 4 8: variance 7.
  const auto got = cronbach_alpha(Values{1, 2, 2, 2, 3, 5}, 2);
  ASSERT_TRUE(got);
  EXPECT_NEAR(got->alpha, 4 * 1.5 / 7, 1e-14);
  EXPECT_EQ(got->n, 3);
  const auto same = cronbach_alpha(Values{1, 1, 2, 2, 4, 4}, 2);
  EXPECT_NEAR(same->alpha, 1, 1e-14) << "items that agree";
}

TEST(CronbachAlpha, AgreesWithRsAnalysisOfVariance) {
  const auto made =
      base::Json::parse(base::read_file(std::string(VIP_TEST_DIR) + "/stats/r/cronbach_alpha.json", 1 << 20));
  int seen = 0;
  for (const auto& study : made.at("studies")) {
    const auto got = cronbach_alpha(oracle::numbers(study.at("rows")), study.at("items"));
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->alpha, study.at("alpha"), 1e-12);
    EXPECT_NEAR(got->ci[0], study.at("low"), 1e-11);
    EXPECT_NEAR(got->ci[1], study.at("high"), 1e-11);
    ++seen;
  }
  EXPECT_EQ(seen, 4);
}

// Parallel items: true alpha = k v / (k v + 1) with the common variance v and errors of variance 1.
TEST(CronbachAlpha, TheIntervalHoldsTheTruth) {
  constexpr int sets = 2000, people = 20, items = 4;
  constexpr double common = 0.8, truth = items * common * common / (items * common * common + 1);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  int held = 0;
  for (int i = 0; i < sets; ++i) {
    Values rows;
    for (int person = 0; person < people; ++person) {
      const double level = common * normal(random);
      for (int item = 0; item < items; ++item) rows.push_back(level + normal(random));
    }
    const auto got = cronbach_alpha(rows, items);
    held += got->ci[0] <= truth && truth <= got->ci[1];
  }
  EXPECT_NEAR(held / static_cast<double>(sets), 0.95, 3 * std::sqrt(0.95 * 0.05 / sets));
}

TEST(CronbachAlpha, LeavesOutWhoLacksAnItemAndRefusesWhatHasNoSpread) {
  const auto got = cronbach_alpha(Values{1, 2, 2, 2, unknown, 9, 3, 5}, 2);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->n, 3);
  EXPECT_EQ(got->n_missing, 1);
  EXPECT_NEAR(got->alpha, 6 / 7.0, 1e-14);
  EXPECT_EQ(cronbach_alpha(Values{1, 2, 2, 1}, 2).reason(), "the sums of the items do not differ");
  EXPECT_FALSE(cronbach_alpha(Values{1, 2, 3}, 1));
  EXPECT_FALSE(cronbach_alpha(Values{1, 2}, 2));
  EXPECT_THROW(cronbach_alpha(Values{1, 2, 3}, 2), std::invalid_argument);
  EXPECT_THROW(cronbach_alpha(Values{1, 2, 3, 4}, 2, 1), std::invalid_argument);
}

}  // namespace
