#include "stats/analysis/factor_levels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stats {
namespace {

using ::testing::HasSubstr;

/// Two levels of the examined factor by two combinations of the other factors make four treatments. Treatment
/// = 2 combination + level.
const std::vector<FactorPlace> places{{0, 0}, {1, 0}, {0, 1}, {1, 1}};

PairChoice choice(int participant, int first, int second, bool first_chosen) {
  return {participant, 0, first, second, first_chosen, 0};
}

TEST(LevelPreferences, CountPairsThatDifferInTheFactorAlone) {
  std::vector<PairChoice> choices;
  for (int person = 0; person < 4; ++person) {
    choices.push_back(choice(person, 0, 1, false));       // everyone chooses level 1 at combination 0
    choices.push_back(choice(person, 3, 2, person > 0));  // all but one choose level 1 at combination 1
    choices.push_back(choice(person, 0, 3, true));        // the other factors differ too: not counted
    choices.push_back(choice(person, 0, 2, true));        // same level: not counted
  }
  const auto found = level_preferences(choices, places, 2, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].n, 8);
  EXPECT_EQ(found[0].k, 1) << "level 0, by the one";
  EXPECT_EQ(found[0].participants, 4);
  ASSERT_TRUE(found[0].shares);
  // The people's shares of .5, 0, 0, 0 against .5: mean .125, standard error .125, t = -3 with 3 degrees of
  // freedom.
  EXPECT_DOUBLE_EQ(found[0].shares->mean, 0.125);
  EXPECT_NEAR(found[0].shares->t, -3, 1e-12);
  EXPECT_NEAR(*found[0].p(), 0.057669, 1e-6) << "R: 2 * pt(-3, 3)";
  EXPECT_EQ(found[0].p(), found[0].p_holm);
}

TEST(LevelPreferences, OfAllAlikeAreTestedBySign) {
  std::vector<PairChoice> choices;
  for (int person = 0; person < 5; ++person) choices.push_back(choice(person, 1, 0, true));
  const auto found = level_preferences(choices, places, 2, {});
  EXPECT_FALSE(found[0].shares);
  ASSERT_TRUE(found[0].all_alike);
  EXPECT_DOUBLE_EQ(*found[0].p(), 2 * std::pow(0.5, 5));
}

TEST(LevelPreferences, WithoutAnswersHaveNoP) {
  const auto found = level_preferences({}, places, 2, {});
  EXPECT_EQ(found[0].n, 0);
  EXPECT_FALSE(found[0].p() || found[0].p_holm);
}

TEST(LevelPreferences, OfThreeLevelsAreCorrectedTogether) {
  const std::vector<FactorPlace> three{{0, 0}, {1, 0}, {2, 0}};
  std::vector<PairChoice> choices;
  for (int person = 0; person < 6; ++person) {
    choices.push_back(choice(person, 0, 1, true));
    choices.push_back(choice(person, 1, 2, person % 2 == 0));
    choices.push_back(choice(person, 0, 2, person > 0));
  }
  const auto found = level_preferences(choices, three, 3, {});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_DOUBLE_EQ(*found[0].p_holm, 3 * *found[0].p()) << "the smallest of three";
}

/// Scores by person and treatment; NaN: not judged.
ScoreTable table_of(const std::vector<std::vector<double>>& scores) {
  std::vector<MethodScore> all;
  for (std::size_t person = 0; person < scores.size(); ++person) {
    for (std::size_t i = 0; i < scores[person].size(); ++i)
      all.push_back({static_cast<int>(person), 0, 0, static_cast<int>(i), scores[person][i]});
  }
  return {{.code = "realism", .label = "Realism", .items = {"realism"}},
          all,
          static_cast<int>(scores.size()),
          {"16k"},
          {"A, none", "A, foam", "B, none", "B, foam"}};
}

TEST(LevelDifferences, AverageOverTheOtherFactorWithinEachParticipant) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto table = table_of({{3, 5, 4, 5}, {2, 4, 4, 4}, {5, 6, 3, 6}, {1, 7, none, 7}});
  const auto found = level_differences(table, places, 2, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].participants, 3u) << "the fourth lacks one of the four";
  ASSERT_TRUE(found[0].difference);
  // The people's differences are -1.5, -1, -2: mean -1.5, standard error .5 / sqrt 3.
  EXPECT_DOUBLE_EQ(found[0].difference->mean, -1.5);
  EXPECT_NEAR(found[0].difference->t, -1.5 / (0.5 / std::sqrt(3)), 1e-12);
  // The people's differences for the other factor: (3 + 5 - 4 - 5) / 2, (2 + 4 - 4 - 4) / 2, (5 + 6 - 3 - 6)
  // / 2.
  const std::vector<FactorPlace> other{{0, 0}, {0, 1}, {1, 0}, {1, 1}};
  EXPECT_NEAR(level_differences(table, other, 2, {})[0].difference->mean, (-0.5 - 1 + 1) / 3, 1e-12);
}

// 13/3 - 10/3 + 4 - 5 is exactly zero, but not in doubles.
TEST(LevelDifferences, OfThirdsThatCancelAreNoughtExactly) {
  std::vector<MethodScore> all;
  for (int person = 0; person < 5; ++person) {
    const std::vector<std::vector<double>> answers{{4, 4, 5}, {3, 3, 4}, {4, 4, 4}, {5, 5, 5}};
    for (std::size_t i = 0; i < answers.size(); ++i) {
      for (std::size_t scene = 0; scene < answers[i].size(); ++scene)
        all.push_back({person, static_cast<int>(scene), 0, static_cast<int>(i), answers[i][scene]});
    }
  }
  const ScoreTable table({.code = "realism", .label = "Realism", .items = {"realism"}}, all, 5, {"16k"},
                         {"A, none", "A, foam", "B, none", "B, foam"});
  const auto found = level_differences(table, places, 2, {});
  EXPECT_FALSE(found[0].difference);
  ASSERT_TRUE(found[0].all_alike);
  EXPECT_EQ(found[0].all_alike->value, 0);
  EXPECT_EQ(found[0].p(), 1);
}

TEST(LevelDifferences, OfOneParticipantAreRefusedWithTheReason) {
  const auto found = level_differences(table_of({{3, 5, 4, 5}}), places, 2, {});
  EXPECT_FALSE(found[0].p());
  EXPECT_THAT(found[0].difference.reason(), HasSubstr("not enough values"));
}

}  // namespace
}  // namespace stats
