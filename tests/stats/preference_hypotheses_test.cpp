/// H4 to H6, the hypotheses about people's preferences between methods, and rules for all six hypotheses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "stats/analysis/hypotheses.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

/// The plan of preregistration bundles from before plans had a decision rule.
AnalysisPlan frozen_earlier() {
  AnalysisPlan plan;
  plan.decision = DecisionRule::Holm;
  plan.directional = Directional::Once;
  return plan;
}

AnalysisPlan one_sided_throughout() {
  AnalysisPlan plan;
  plan.directional = Directional::All;
  return plan;
}

/// H4 to H6 from ten pairs, each answered by 26 people. Each number is how often the first method in its name
/// was chosen.
std::vector<Hypothesis> preferences(int tsp_over_ours, int ours_over_fov, int tsp_over_fov,
                                    int hires_over_ours, int hires_over_tsp,
                                    const std::string& untestable = "", const AnalysisPlan& plan = {}) {
  std::vector<PairChoice> choices;
  for (int a = 0; a < 5; ++a) {
    for (int b = a + 1; b < 5; ++b) {
      int k = 13;
      if (a == 2 && b == 3) k = 26 - tsp_over_ours;
      if (a == 1 && b == 2) k = 26 - ours_over_fov;
      if (a == 1 && b == 3) k = 26 - tsp_over_fov;
      if (a == 2 && b == 4) k = 26 - hires_over_ours;
      if (a == 3 && b == 4) k = 26 - hires_over_tsp;
      test::add_pair(choices, a, b, k, 26);
    }
  }
  return task2_hypotheses(count_preferences(choices, 5, {}), test::methods, plan, untestable);
}

TEST(PreferenceHypotheses, ThePapersFigureTen) {
  const auto all = preferences(15, 19, 21, 13, 11);
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_EQ(all[0].status, HypothesisStatus::NotSupported);
  const Hypothesis& h5 = all[1];
  EXPECT_EQ(h5.status, HypothesisStatus::Supported);
  EXPECT_EQ(h5.tests[0].k, 19);
  EXPECT_NEAR(*h5.tests[0].p, 0.029, 0.0005);
  EXPECT_NEAR(*h5.tests[1].p, 0.002, 0.0006);
  EXPECT_NEAR(*h5.tests[0].p_holm, 0.029, 0.0005);
  EXPECT_NEAR(*h5.tests[1].p_holm, 0.005, 0.0003);
  EXPECT_NEAR(*h5.tests[0].p_holm_of_five, 0.116, 0.001);
  EXPECT_NEAR(*h5.tests[1].p_holm_of_five, 0.012, 0.0006);
  EXPECT_NEAR(*h5.tests[0].p_holm_of_ten, 0.261, 0.0015);
  EXPECT_NEAR(*h5.tests[1].p_holm_of_ten, 0.025, 0.0006);
  // The paper calls H6 confirmed because no test is significant; here nothing is confirmed.
  EXPECT_TRUE(all[2].paper_supported);
  EXPECT_EQ(all[2].status, HypothesisStatus::NotSupported);
}

TEST(PreferenceHypotheses, ThePreferenceMustPointTheRightWay) {
  const auto all = preferences(3, 2, 3, 24, 23);
  EXPECT_EQ(all[0].status, HypothesisStatus::NotSupported);
  EXPECT_TRUE(all[0].tests[0].against);
  EXPECT_FALSE(all[0].paper_supported);
  EXPECT_EQ(all[1].status, HypothesisStatus::NotSupported);
  EXPECT_EQ(all[2].status, HypothesisStatus::Supported);
}

TEST(PreferenceHypotheses, IntervalsHoldWhatTheLevelLeaves) {
  AnalysisPlan plan;
  plan.alpha = 0.01;
  // 20 of 26: p = .0094.
  const auto h6 = preferences(13, 13, 13, 20, 13, "", plan)[2];
  EXPECT_DOUBLE_EQ(h6.tests[0].ci_confidence, 0.99);
  EXPECT_LT(*h6.tests[0].p, 0.01);
  EXPECT_GT((*h6.tests[0].ci)[0], 0.5);
}

TEST(PreferenceHypotheses, OneSidedWhereThePlanSaysSo) {
  // 18 of 26: two-sided p = .076, one-sided .038.
  const auto two = preferences(13, 13, 13, 18, 18)[2];
  EXPECT_NEAR(*two.tests[0].p, 0.0755, 0.0005);
  EXPECT_EQ(two.status, HypothesisStatus::NotSupported);
  const auto one = preferences(13, 13, 13, 18, 18, "", one_sided_throughout())[2];
  EXPECT_NEAR(*one.tests[0].p, 0.0378, 0.0005);
  EXPECT_NEAR(*one.tests[0].paper_p, 0.0755, 0.0005);
  EXPECT_EQ((*one.tests[0].ci)[1], 1);
  EXPECT_GT((*one.tests[0].ci)[0], 0.5) << "the bound decides as p does";
  EXPECT_LT((*two.tests[0].ci)[0], 0.5);
  EXPECT_EQ(one.status, HypothesisStatus::Supported) << "each below .05, which is what the claim needs";
  const auto earlier = preferences(13, 13, 13, 18, 18, "", frozen_earlier())[2];
  EXPECT_NEAR(*earlier.tests[0].p, 0.0378, 0.0005) << "H6 was one-sided";
  EXPECT_EQ(earlier.status, HypothesisStatus::NotSupported) << "2 x .038 after Holm";
}

// A claim that needs all of its tests needs no correction: its error is at most alpha (Berger 1982).
TEST(PreferenceHypotheses, AClaimThatNeedsAllItsTestsIsNotCorrected) {
  const auto h5 = preferences(13, 19, 19, 13, 13)[1];  // p = .029 twice
  EXPECT_EQ(h5.status, HypothesisStatus::Supported) << h5.status_text;
  EXPECT_EQ(h5.confirmed, 2);
  EXPECT_EQ(h5.confirmed_holm, 0) << "2 x .029";
  EXPECT_THAT(h5.status_text, HasSubstr("2 of 2 preference tests hold at 0.05 each, and the claim needs all; "
                                        "0 of 2 after Holm"));
  EXPECT_NEAR(*h5.p_claim, 0.029, 0.0005);
  const auto earlier = preferences(13, 19, 19, 13, 13, "", frozen_earlier())[1];
  EXPECT_EQ(earlier.status, HypothesisStatus::NotSupported) << earlier.status_text;
  EXPECT_NEAR(*earlier.p_claim, 0.058, 0.001);
}

// "At least one" is a different claim, and needs Holm.
TEST(PreferenceHypotheses, OneTestOfSeveralIsClaimedAfterHolmOnly) {
  const auto weak = preferences(13, 19, 13, 13, 13)[1];
  EXPECT_EQ(weak.confirmed, 1);
  EXPECT_EQ(weak.status, HypothesisStatus::NotSupported) << weak.status_text;
  const auto strong = preferences(13, 22, 13, 13, 13)[1];
  EXPECT_EQ(strong.status, HypothesisStatus::PartlySupported) << strong.status_text;
  EXPECT_EQ(*strong.p_claim, 1) << "the other test speaks for nothing";
}

TEST(PreferenceHypotheses, AClaimWithOneFalseTestIsSupportedAtTheLevelOfThatTest) {
  // 95 % of people choose HiRes over Ours, and 50 % HiRes over Ours-TSp: H6 is false. The second test alone
  // decides, at the attainable level of 26 choices: 18 and more one-sided, 19 two-sided.
  constexpr int studies = 4000;
  std::mt19937_64 generator(8);
  std::binomial_distribution<int> often(26, 0.95), even(26, 0.5);
  int supported[2] = {}, by_holm[2] = {};
  for (int study = 0; study < studies; ++study) {
    std::vector<PairChoice> choices;
    test::add_pair(choices, 2, 4, 26 - often(generator), 26);
    test::add_pair(choices, 3, 4, 26 - even(generator), 26);
    for (int sided : {0, 1}) {
      AnalysisPlan plan = sided ? one_sided_throughout() : AnalysisPlan{};
      const auto pairs = count_preferences(choices, 5, plan);
      const auto is = [&] {
        return task2_hypotheses(pairs, test::methods, plan, "")[2].status == HypothesisStatus::Supported;
      };
      supported[sided] += is() ? 1 : 0;
      plan.decision = DecisionRule::Holm;
      by_holm[sided] += is() ? 1 : 0;
    }
  }
  const double three_errors = 3 * std::sqrt(0.04 * 0.96 / studies);
  EXPECT_NEAR(1.0 * supported[0] / studies, 0.0145, three_errors);
  EXPECT_NEAR(1.0 * supported[1] / studies, 0.0378, three_errors);
  EXPECT_LE(by_holm[0], supported[0]);
  EXPECT_LE(by_holm[1], supported[1]);
}

TEST(PreferenceHypotheses, TheSixClaimsAreCorrectedBesideTheDecisions) {
  auto claims = preferences(21, 19, 21, 13, 11, "gaze was not tracked");
  const double h4 = *claims[0].p_claim;
  correct_over_claims(claims, 6);
  EXPECT_NEAR(*claims[0].p_claim_of_six, 6 * h4, 1e-15) << "H1 to H3 and H5 count as p = 1";
  EXPECT_FALSE(claims[1].p_claim_of_six.has_value()) << "what cannot be tested cannot be claimed";
  EXPECT_EQ(*claims[2].p_claim_of_six, 1);
  EXPECT_EQ(claims[0].status, HypothesisStatus::Supported) << "the decision is the claim's own";
}

// compare_with_bundle compares these words with those of the bundle.
TEST(PreferenceHypotheses, BundlesFrozenEarlierFindTheirRulesWordForWord) {
  std::vector<std::string> rules;
  for (const auto& one : task1_hypotheses(
           test::normal_table({4, 4, 4, 4, 4}, 1, 1, 9, 1),
           test::normal_table({1, 1, 1, 1, 1}, 1, 1, 9, 2, test::sickness_scale()), frozen_earlier(), ""))
    rules.push_back(one.rule);
  for (const auto& one : preferences(13, 13, 13, 13, 13, "", frozen_earlier())) rules.push_back(one.rule);
  EXPECT_THAT(
      rules,
      ElementsAre("paired t tests, two-sided, significant after Holm and in the direction of better",
                  "two one-sided paired t tests against the margins, significant after Holm",
                  "one-sided paired t tests against the margins, significant after Holm",
                  "exact binomial test, two-sided, significant and more often chosen",
                  "exact binomial tests, two-sided, significant after Holm and more often chosen",
                  "exact binomial tests, one-sided (HiRes chosen more often), significant after Holm"));
}

TEST(PreferenceHypotheses, WithoutTrackedGazeTheFifthIsNotTestable) {
  const auto all = preferences(22, 22, 22, 22, 22, "gaze was not tracked");
  EXPECT_EQ(all[0].status, HypothesisStatus::Supported);
  EXPECT_EQ(all[1].status, HypothesisStatus::NotTestable);
  EXPECT_EQ(all[1].status_if_testable, HypothesisStatus::Supported);
  EXPECT_EQ(all[2].status, HypothesisStatus::Supported);
}

TEST(PreferenceHypotheses, ARefusedPairCountsAsOneInItsFamily) {
  std::vector<PairChoice> choices;
  test::add_pair(choices, 1, 2, 5, 26);
  const auto h5 = task2_hypotheses(count_preferences(choices, 5, {}), test::methods, {}, "")[1];
  EXPECT_EQ(h5.status, HypothesisStatus::PartlySupported);
  EXPECT_NEAR(*h5.tests[0].p_holm, 2 * *h5.tests[0].p, 1e-15);
  EXPECT_THAT(h5.tests[1].reason, Not(IsEmpty()));
}

}  // namespace
}  // namespace stats
