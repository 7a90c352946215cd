/// Doubts about a pilot (ratings at settings of the frame rate) for which no solver may use its fit: each has
/// its code, and ratings that rise with the frame rate raise none.
#include "stats/ptpe/pilot_doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>

#include "tests/stats/ptpe/simulated_ratings.hpp"

namespace {

using Codes = std::set<std::string>;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

Codes doubts_of(const std::vector<stats::PilotRating>& ratings, int resamples = 200) {
  const stats::PilotTable table(ratings);
  const stats::BootstrapOptions options{resamples, 1, 0.95};
  const auto direct = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, options);
  const auto contour = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, options);
  const auto ordinal = stats::estimate_ordinal_pilot(ratings, stats::PilotMean::Harmonic, 4, 0.95);
  Codes codes;
  for (const auto& doubt : stats::pilot_doubts(table, direct, contour, ordinal)) {
    EXPECT_TRUE(codes.insert(doubt.code).second) << doubt.code << " twice";
    EXPECT_THAT(doubt.text, Not(IsEmpty()));
  }
  return codes;
}

/// A simulated pilot of 16 people in which `score` gives each rating its score, rounded and limited to 1 to
/// 7.
std::vector<stats::PilotRating> changed(const std::function<double(const stats::PilotRating&)>& score) {
  auto ratings = simulated::pilot({}, 16, 3);
  for (auto& rating : ratings) rating.score = std::clamp(std::round(score(rating)), 1.0, 7.0);
  return ratings;
}

TEST(PilotDoubts, ARisingPilotHasNone) { EXPECT_THAT(doubts_of(simulated::pilot({}, 16, 3)), IsEmpty()); }

TEST(PilotDoubts, ReversedRatingsNeitherRiseNorStay) {
  const auto codes = doubts_of(changed([](const auto& r) { return 8 - r.score; }));
  EXPECT_THAT(codes, Contains("no_rise"));
  EXPECT_THAT(codes, Contains("falls"));
}

// Both ends are equal and the middle is lower, so a slope could not detect it.
TEST(PilotDoubts, UShapedRatingsFall) {
  const auto codes =
      doubts_of(changed([](const auto& r) { return 2 + std::abs(r.mu - 30) / 5 + 0.3 * r.score; }));
  EXPECT_THAT(codes, Contains("falls"));
}

TEST(PilotDoubts, ScoresThatLevelOffAreNotAFall) {
  const auto codes = doubts_of(changed([](const auto& r) { return r.mu > 30 ? 6 : r.score; }));
  EXPECT_THAT(codes, Not(Contains("falls")));
  EXPECT_THAT(codes, Not(Contains("no_rise")));
}

TEST(PilotDoubts, PeopleWhoAllAgreeHaveNoSpread) {
  auto one = simulated::pilot({24, 0.02, 0.14, 0, 0}, 8, 1);
  EXPECT_THAT(doubts_of(one), Contains("no_spread"));
  const stats::PilotTable table(one);
  const auto direct = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0, 1, 0.95});
  EXPECT_THAT(direct.lack_of_fit.reason(), testing::HasSubstr("the participants agree"));
}

TEST(PilotDoubts, ALikingOfFluctuationIsDoubted) {
  const auto codes = doubts_of(simulated::pilot({30, -0.03}, 16, 1));
  EXPECT_THAT(codes, Contains("b_below_zero"));
}

TEST(PilotDoubts, ACurveThatLeavesTheSettingsAlmostEverywhereIsDoubted) {
  EXPECT_THAT(doubts_of(simulated::pilot({44, 0.035}, 16, 2)), Contains("few_deltas"));
}

TEST(PilotDoubts, EstimatorsWithNothingInCommonAreNamed) {
  const stats::PilotTable table(simulated::pilot({}, 16, 3));
  const stats::BootstrapOptions options{200, 1, 0.95};
  const auto direct = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, options);
  auto contour = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, options);
  EXPECT_THAT(stats::pilot_doubts(table, direct, contour, {}), IsEmpty());
  contour.spread = stats::PilotSpread{{40, 45}, {0.01, 0.03}, 1, 0.01, 200, 0, false};
  const auto doubts = stats::pilot_doubts(table, direct, contour, {});
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].code, "estimators_disagree");
  EXPECT_THAT(doubts[0].text, ::testing::HasSubstr("[40, 45] by the contour one"));
}

// For truths that labs may meet, at most one good pilot in twenty is refused.
TEST(PilotDoubtsSlow, RefuseFewGoodPilots) {
  constexpr int pilots = 200;
  for (const double a : {18.0, 24.0, 30.0}) {
    for (const double b : {0.01, 0.02, 0.03}) {
      std::vector<Codes> all(pilots);
#pragma omp parallel for schedule(dynamic)
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = doubts_of(simulated::pilot({a, b}, 16, i + 1));
      const auto refused =
          std::count_if(all.begin(), all.end(), [](const Codes& codes) { return !codes.empty(); });
      std::printf("a = %g, b = %g: %ld of %d refused\n", a, b, static_cast<long>(refused), pilots);
      EXPECT_LE(refused, 0.05 * pilots + 2 * std::sqrt(0.05 * 0.95 * pilots)) << a << " " << b;
    }
  }
}

}  // namespace
