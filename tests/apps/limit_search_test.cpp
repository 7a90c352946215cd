#include "libsim/measure/stability_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace apps {
namespace {

using ::testing::Each;
using ::testing::Ge;
using ::testing::Le;

/// Passes up to a limit and records what was tried.
struct UpTo {
  double limit;
  std::vector<double>& tried;
  std::string operator()(double factor) const {
    tried.push_back(factor);
    return factor <= limit ? "" : "breaks at " + std::to_string(factor);
  }
};

TEST(LargestFactor, IsWithinItsResolutionOfTheLimit) {
  for (const double limit : {1.0, 1.3, 2.0, 3.1, 3.999}) {
    for (const double resolution : {1.05, 1.2, 2.0}) {
      std::vector<double> tried;
      const auto found = measure::largest_factor(UpTo{limit, tried}, 4, resolution);
      EXPECT_EQ(found.reach, measure::Reach::Found);
      EXPECT_LE(found.passed, limit);
      EXPECT_GE(found.passed * resolution * (1 + 1e-6), limit) << limit << " " << resolution;
      EXPECT_EQ(found.runs, static_cast<int>(tried.size()));
      EXPECT_THAT(tried, Each(Le(4)));
      EXPECT_THAT(tried, Each(Ge(1)));
      // The message belongs to the failing factor nearest to the limit.
      double nearest = 4;
      for (const double one : tried) {
        if (one > limit) nearest = std::min(nearest, one);
      }
      EXPECT_EQ(found.failed, "breaks at " + std::to_string(nearest));
      EXPECT_LE(nearest, found.passed * resolution * (1 + 1e-6));
    }
  }
}

TEST(LargestFactor, TriesNoMoreThanItMust) {
  std::vector<double> tried;
  measure::largest_factor(UpTo{1, tried}, 4, 2);
  EXPECT_EQ(tried, (std::vector<double>{4, 2}));
  tried.clear();
  measure::largest_factor(UpTo{1, tried}, 2, 2);
  EXPECT_EQ(tried, (std::vector<double>{2}));
}

TEST(LargestFactor, SaysThatAllPassed) {
  std::vector<double> tried;
  const auto found = measure::largest_factor(UpTo{9, tried}, 4, 1.1);
  EXPECT_EQ(found.reach, measure::Reach::AllPass);
  EXPECT_EQ(found.passed, 4);
  EXPECT_EQ(found.failed, "");
  EXPECT_EQ(tried.size(), 1u);
}

/// The search assumes that every factor below a passing one passes. It does not find failures from 1.5 to
/// 1.9, because larger factors pass.
TEST(LargestFactor, TrustsThatWhatPassesPassesBelow) {
  const auto found = measure::largest_factor(
      [](double factor) { return factor > 1.5 && factor < 1.9 ? "a hole"
                                 : factor > 3                 ? "too far"
                                                              : ""; }, 4,
      1.2);
  EXPECT_EQ(found.failed, "too far");
  EXPECT_GT(found.passed, 2);
}

TEST(Fewest, IsTheLeastThatPasses) {
  for (int usual = 1; usual <= 9; ++usual) {
    for (int least = 1; least <= usual; ++least) {
      const auto found = measure::fewest(
          [&](int count) { return count >= least ? "" : "breaks with " + std::to_string(count); }, usual);
      EXPECT_EQ(found.passed, least) << usual;
      EXPECT_EQ(found.reach, least == 1 ? measure::Reach::AllPass : measure::Reach::Found);
      EXPECT_EQ(found.failed, least == 1 ? "" : "breaks with " + std::to_string(least - 1));
    }
  }
}

}  // namespace
}  // namespace apps
