#include "stats/adaptive/staircase.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string_view>

#include "stats/adaptive/psychometric.hpp"

using namespace stats;

namespace {

/// Replays responses written as C (positive) and i.
StaircaseTrack replay(const StaircaseRules& rules, std::string_view responses) {
  const auto positive = std::make_unique<bool[]>(responses.size());
  for (std::size_t i = 0; i < responses.size(); ++i) positive[i] = responses[i] == 'C';
  return replay_staircase(rules, {positive.get(), responses.size()});
}

}  // namespace

TEST(Staircase, FollowsPsychoPysReferenceTrack) {
  // The track that the test suite of PsychoPy (Peirce et al. 2019) expects of its StairHandler: 1 up 3 down
  // with three step sizes, the initial rule, and cycles of four positive and four negative responses.
  const StaircaseRules rules{.start = 0.8,
                             .lowest = 0,
                             .highest = 1,
                             .down_after = 3,
                             .steps = {0.1, 0.01, 0.001},
                             .fast_start = true,
                             .trials = 20,
                             .reversals = 4};
  const StaircaseTrack track = replay(rules, "CCCCiiiiCCCCiiiiCCCC");
  const std::vector expected{0.8,  0.7,   0.6,   0.5,  0.4,   0.41,  0.42,  0.43,  0.44,  0.44,
                             0.44, 0.439, 0.439, 0.44, 0.441, 0.442, 0.443, 0.443, 0.443, 0.442};
  ASSERT_EQ(track.stimuli.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(track.stimuli[i], expected[i], 1e-12) << i;
  EXPECT_EQ(track.reversals, (std::vector{4, 10, 12, 18}));
  EXPECT_TRUE(track.ended);
  EXPECT_NEAR(*reversal_mean(rules, track, 2), (0.439 + 0.443) / 2, 1e-12);
}

TEST(Staircase, TwoDownOneUpFollowsLevittsTable) {
  // Levitt 1971, table 1: two positive responses in a row move down, one negative or positive-negative moves
  // up.
  const StaircaseRules rules{.start = 10, .lowest = 0, .highest = 20, .down_after = 2, .steps = {1}};
  const StaircaseTrack track = replay(rules, "CCCiCCiCCCC");
  EXPECT_EQ(track.stimuli, (std::vector<double>{10, 10, 9, 9, 10, 10, 9, 10, 10, 9, 9, 8}));
  EXPECT_EQ(track.reversals, (std::vector{3, 5, 6, 8}));
  EXPECT_FALSE(track.ended);
  EXPECT_NEAR(*target_share(rules), 0.7071, 1e-4);
}

TEST(Staircase, DecibelsMultiplyAndBoundsHold) {
  const StaircaseRules rules{.start = 8, .lowest = 4, .highest = 16, .steps = {6.0206}, .decibels = true};
  const StaircaseTrack track = replay(rules, "CCCiii");
  const std::vector expected{8.0, 4.0, 4.0, 4.0, 8.0, 16.0, 16.0};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(track.stimuli[i], expected[i], 1e-4);
}

TEST(Staircase, EachRuleConvergesToItsShare) {
  const PsychometricCurve person{.threshold = 50, .shape = 12};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit;
  StaircaseRules levitt2{.start = 60, .lowest = 0, .highest = 200, .down_after = 2, .steps = {1}};
  StaircaseRules levitt3 = levitt2, kaernbach = levitt2;
  levitt3.down_after = 3;
  kaernbach.down_after = 1;
  kaernbach.up_ratio = 3;
  for (const StaircaseRules& rules : {levitt2, levitt3, kaernbach}) {
    constexpr std::size_t trials = 4000;
    const auto positive = std::make_unique<bool[]>(trials);
    double x = rules.start, sum = 0;
    // Replaying a session takes time quadratic in its trials. So each block of 200 trials is a session that
    // begins at the last stimulus of the block before.
    for (std::size_t done = 0; done < trials; done += 200) {
      StaircaseRules block = rules;
      block.start = x;
      for (std::size_t i = 0; i < 200; ++i) {
        positive[i] = unit(random) < person(x);
        x = replay_staircase(block, {positive.get(), i + 1}).stimuli.back();
        if (done > 0) sum += x;
      }
    }
    EXPECT_NEAR(person(sum / (trials - 200)), *target_share(rules), 0.02) << rules.down_after;
  }
}

TEST(Staircase, RefusesRulesOutOfRange) {
  const StaircaseRules good{.start = 1, .lowest = 0, .highest = 2};
  EXPECT_NO_THROW(replay(good, "C"));
  for (auto spoil :
       {+[](StaircaseRules& r) { r.start = 3; }, +[](StaircaseRules& r) { r.steps = {}; },
        +[](StaircaseRules& r) { r.steps = {0}; }, +[](StaircaseRules& r) { r.down_after = 0; },
        +[](StaircaseRules& r) { r.up_ratio = 0; }, +[](StaircaseRules& r) { r.decibels = true; }}) {
    StaircaseRules bad = good;
    spoil(bad);
    EXPECT_THROW(replay(bad, "C"), std::invalid_argument);
  }
  EXPECT_FALSE(reversal_mean(good, replay(good, "CCC"), 0));
  EXPECT_FALSE(target_share({.down_after = 2, .up_after = 2}));
}
