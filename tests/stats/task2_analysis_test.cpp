#include "stats/analysis/task2.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const PairPreference& pair_of(const PreferenceAnalysis& analysis, int a, int b) {
  for (const auto& pair : analysis.pairs) {
    if (pair.a == a && pair.b == b) return pair;
  }
  throw std::logic_error("the analysis has no pair of methods a and b; mend: name the lower index first");
}

TEST(Task2, CountsWhoWasChosenWhereverItStood) {
  // 1 beats 0 as the second shown; 0 beats 1 as the first; 1 beats 0 as the first.
  const std::vector<PairChoice> choices{{0, 0, 0, 1, false, 0}, {1, 0, 0, 1, true, 0}, {2, 0, 1, 0, true, 0}};
  const auto pair = count_preferences(choices, 2, {}).at(0);
  EXPECT_EQ(pair.n, 3);
  EXPECT_EQ(pair.k, 1);
  EXPECT_EQ(pair.a_first, 2);
  EXPECT_EQ(pair.first_chosen, 2);
  EXPECT_EQ(pair.participants, 3);
  EXPECT_EQ(pair.max_per_participant, 1);
  ASSERT_TRUE(pair.test);
  EXPECT_NEAR(pair.test->p, 1.0, 1e-15);
}

TEST(Task2, ThePapersPairsOverFamiliesOfTwoFiveAndTen) {
  std::vector<PairChoice> choices;
  for (int a = 0; a < 5; ++a) {
    for (int b = a + 1; b < 5; ++b) {
      const bool ours = a == 1 && b == 2, tsp = a == 1 && b == 3;
      test::add_pair(choices, a, b, ours ? 26 - 19 : tsp ? 26 - 21 : 13, 26);
    }
  }
  const auto analysis = analyse_preferences(choices, 5, {});
  EXPECT_NEAR(pair_of(analysis, 1, 2).test->p, 0.029, 0.0005);
  EXPECT_NEAR(pair_of(analysis, 1, 3).test->p, 0.002, 0.0006);
  EXPECT_NEAR(*pair_of(analysis, 1, 2).p_holm, 0.261, 0.0015);
  EXPECT_NEAR(*pair_of(analysis, 1, 3).p_holm, 0.025, 0.0006);
  EXPECT_NEAR(*pair_of(analysis, 0, 1).p_holm, 1, 1e-15);
}

TEST(Task2, SeveralTrialsOfOnePersonAreRefusedOrWarnedOf) {
  std::vector<PairChoice> choices;
  test::add_pair(choices, 0, 1, 9, 10);
  choices.push_back(choices.back());
  AnalysisPlan plan;
  plan.repeated_pairs = RepeatedPairs::Refuse;
  const auto refused = count_preferences(choices, 2, plan).at(0);
  EXPECT_FALSE(refused.test);
  EXPECT_THAT(refused.test.reason(), HasSubstr("2 times"));
  EXPECT_EQ(refused.max_per_participant, 2);
  EXPECT_EQ(refused.participants, 10);
  plan.repeated_pairs = RepeatedPairs::Warn;
  const auto warned = count_preferences(choices, 2, plan).at(0);
  EXPECT_TRUE(warned.test);
  EXPECT_THAT(warned.warning, HasSubstr("not independent"));
  choices.pop_back();
  EXPECT_THAT(count_preferences(choices, 2, plan).at(0).warning, IsEmpty());
}

// By default the test uses each person's share, so a second visit is no problem.
TEST(Task2, SecondVisitsAreTestedByEachPersonsShare) {
  std::vector<PairChoice> choices;
  test::add_pair(choices, 0, 1, 9, 10);
  const auto once = count_preferences(choices, 2, {}).at(0);
  EXPECT_FALSE(once.shares);
  EXPECT_NEAR(*once.p(), 2 * 11 / 1024.0, 1e-15);
  // Everybody repeats their answers: the shares are the same, and the evidence is not doubled.
  for (auto again : std::vector<PairChoice>(choices)) choices.push_back(again);
  const auto twice = count_preferences(choices, 2, {}).at(0);
  ASSERT_TRUE(twice.shares);
  EXPECT_EQ(twice.n, 20);
  EXPECT_EQ(twice.shares->participants, 10);
  EXPECT_NEAR(*twice.p(), *once.p(), 1e-15);
  EXPECT_NEAR(twice.shares->share, 0.9, 1e-15);
  EXPECT_NEAR(*twice.p_holm, *once.p(), 1e-15);
  EXPECT_EQ(twice.several, 10);
  EXPECT_THAT(twice.warning, IsEmpty()) << "the test holds";
  EXPECT_THAT(twice.shares->ci_name, HasSubstr("Student's t"));
  AnalysisPlan first;
  first.repeated_pairs = RepeatedPairs::First;
  const auto counted = count_preferences(choices, 2, first).at(0);
  EXPECT_EQ(counted.n, 10);
  EXPECT_NEAR(counted.test->p, *once.p(), 1e-15);
  EXPECT_THAT(counted.warning, IsEmpty());
}

// The reason must not claim that a person who answered a pair twice left one out.
TEST(Task2, TheReasonForNoTriadsIsTheRightOne) {
  std::vector<PairChoice> choices;
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}}) test::add_pair(choices, a, b, 5, 8);
  EXPECT_TRUE(analyse_preferences(choices, 3, {}).group_triads);
  for (auto again : std::vector<PairChoice>(choices)) choices.push_back(again);
  EXPECT_THAT(analyse_preferences(choices, 3, {}).group_triads.reason(),
              HasSubstr("8 of 8 participants answered a pair more than once"));
  std::vector<PairChoice> one_pair;
  test::add_pair(one_pair, 0, 1, 5, 8);
  EXPECT_THAT(analyse_preferences(one_pair, 3, {}).group_triads.reason(),
              HasSubstr("none of 8 participants answered every pair"));
  EXPECT_THAT(analyse_preferences(one_pair, 2, {}).group_triads.reason(),
              HasSubstr("fewer than three methods"));
}

// All signs of the shares of two to seven people with one to three answers each.
TEST(ShareTest, IsExactByGoingThroughAllSigns) {
  const std::vector<PersonChoices> kinds{{0, 1}, {1, 1}, {0, 2}, {1, 2}, {2, 3}, {1, 3}};
  for (int sample = 0; sample < 400; ++sample) {
    std::vector<PersonChoices> people;
    for (std::size_t i = 0; i < 2 + static_cast<std::size_t>(sample) % 6; ++i)
      people.push_back(kinds[(static_cast<std::size_t>(sample) * (2 * i + 3) / (i + 2) + i) % kinds.size()]);
    int seen = 0;  // sum of k / n - 1/2 over people, in twelfths
    std::vector<int> values;
    for (const auto& one : people) {
      values.push_back((2 * one.k - one.n) * (6 / one.n));
      seen += values.back();
    }
    int two_sided = 0, greater = 0;
    for (int signs = 0; signs < 1 << people.size(); ++signs) {
      int sum = 0;
      for (std::size_t i = 0; i < people.size(); ++i) sum += (signs >> i & 1) ? values[i] : -values[i];
      two_sided += std::abs(sum) >= std::abs(seen);
      greater += sum >= seen;
    }
    const double all = 1 << people.size();
    EXPECT_NEAR(share_test(people, Alternative::TwoSided, 0.95)->p, two_sided / all, 1e-14);
    EXPECT_NEAR(share_test(people, Alternative::Greater, 0.95)->p, greater / all, 1e-14);
  }
}

TEST(ShareTest, IsTheBinomialTestWhereEverybodyAnsweredOnce) {
  for (int k = 0; k <= 12; ++k) {
    std::vector<PersonChoices> people;
    for (int i = 0; i < 12; ++i) people.push_back({i < k ? 1 : 0, 1});
    for (const auto side : {Alternative::TwoSided, Alternative::Greater})
      EXPECT_NEAR(share_test(people, side, 0.95)->p, binomial_test(k, 12, 0.5, side, 0.95)->p, 1e-13) << k;
  }
}

TEST(Task2, PairsWithoutAnswersStandWithAReason) {
  std::vector<PairChoice> choices;
  test::add_pair(choices, 0, 1, 5, 10);
  const auto analysis = analyse_preferences(choices, 3, {});
  ASSERT_THAT(analysis.pairs, SizeIs(3));
  EXPECT_EQ(pair_of(analysis, 0, 2).n, 0);
  EXPECT_FALSE(pair_of(analysis, 0, 2).test);
  EXPECT_FALSE(analysis.bradley_terry) << "method 3 was never compared";
  EXPECT_FALSE(analysis.group_triads);
}

TEST(Task2, IntervalBiasIsSeenWithinParticipants) {
  // Everybody chooses the first interval in three of four pairs.
  std::vector<PairChoice> choices;
  for (int person = 0; person < 12; ++person) {
    for (int trial = 0; trial < 4; ++trial) {
      const bool swapped = (person + trial) % 2 == 0;
      choices.push_back({person, 0, swapped ? 1 : 0, swapped ? 0 : 1, trial != person % 3, trial});
    }
  }
  const auto bias = analyse_preferences(choices, 2, {}).interval;
  EXPECT_EQ(bias.n, 48);
  EXPECT_EQ(bias.first_chosen, 36);
  EXPECT_LT(bias.test->p, 0.001);
  EXPECT_FALSE(bias.by_participant) << "all shares are equal: no variance to test against";
  ASSERT_TRUE(bias.model);
  EXPECT_GT(bias.model->interval.estimate, 0);
}

TEST(Task2, CircularTriadsNeedEveryPairOnce) {
  // Person 0: 0 > 1 > 2 > 0, one circle. Person 1 left out a pair.
  const std::vector<PairChoice> choices{{0, 0, 0, 1, true, 0},
                                        {0, 0, 1, 2, true, 1},
                                        {0, 0, 0, 2, false, 2},
                                        {1, 0, 0, 1, true, 0},
                                        {1, 0, 1, 2, true, 1}};
  const auto analysis = analyse_preferences(choices, 3, {});
  ASSERT_THAT(analysis.triads, SizeIs(2));
  EXPECT_EQ(analysis.triads[0].triads->triads, 1);
  EXPECT_EQ(analysis.triads[0].triads->zeta, 0);
  EXPECT_FALSE(analysis.triads[1].triads);
  EXPECT_EQ(analysis.group_triads->participants, 1);
}

TEST(Task2, MethodsOutsideAreProgrammingErrors) {
  const std::vector<PairChoice> outside{{0, 0, 0, 5, true, 0}}, itself{{0, 0, 1, 1, true, 0}};
  EXPECT_THROW(analyse_preferences(outside, 5, {}), std::invalid_argument);
  EXPECT_THROW(analyse_preferences(itself, 5, {}), std::invalid_argument);
}

}  // namespace
}  // namespace stats
