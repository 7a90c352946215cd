#include "stats/analysis/hypotheses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stats/inference/equivalence.hpp"
#include "stats/inference/t_test.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using test::normal_table;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double noise = 0.3;

/// Means in the order LoRes, FovFluid, Ours, Ours-TSp, HiRes.
std::vector<Hypothesis> verdicts(const std::vector<double>& realism, const std::vector<double>& sickness,
                                 int n = 26, const std::string& untestable = "", std::uint64_t seed = 3) {
  return task1_hypotheses(normal_table(realism, 0.5, noise, n, seed),
                          normal_table(sickness, 0.2, noise / 4, n, seed + 100, test::sickness_scale()), {},
                          untestable);
}

TEST(Hypotheses, FamiliesHaveTheSizesPlanned) {
  const auto all = verdicts({2, 3, 5, 5, 5}, {1, 1, 0.5, 0.5, 0.5});
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_THAT(all[0].tests, SizeIs(8));
  EXPECT_THAT(all[1].tests, SizeIs(8));
  EXPECT_THAT(all[2].tests, SizeIs(4));
  EXPECT_EQ(all[0].tests[0].label, "Ours - FovFluid, realism, 16k");
  EXPECT_EQ(all[0].tests[7].label, "Ours-TSp - FovFluid, sickness, 32k");
  EXPECT_EQ(all[2].tests[0].label, "Ours-TSp - Ours, realism, 16k");
}

TEST(Hypotheses, AWorldAsClaimedIsSupportedThroughout) {
  for (const auto& one : verdicts({2, 3, 5, 5, 5}, {1.5, 1, 0.5, 0.5, 0.5})) {
    EXPECT_EQ(one.status, HypothesisStatus::Supported) << one.id << ": " << one.status_text;
    EXPECT_EQ(one.confirmed, static_cast<int>(one.tests.size()));
  }
}

TEST(Hypotheses, BetterMeansMoreRealismAndLessSickness) {
  // FovFluid looks better and sickens more: sickness alone speaks for ours.
  const auto h1 = verdicts({2, 5, 3, 3, 5}, {1, 1, 0.5, 0.5, 0.5})[0];
  EXPECT_EQ(h1.status, HypothesisStatus::PartlySupported);
  EXPECT_EQ(h1.confirmed, 4);
  for (const auto& test : h1.tests) {
    EXPECT_EQ(test.holds, test.score == "sickness") << test.label;
    EXPECT_EQ(test.against, test.score == "realism") << test.label;
    EXPECT_EQ(test.paper_holds, test.holds);
  }
  EXPECT_THAT(h1.status_text, HasSubstr("4 of 8 significant in the other direction"));
}

TEST(Hypotheses, NoDifferenceIsNoEquivalenceWithFewPeople) {
  // The paper's rule takes silence for consent: six noisy people show no difference, and no equivalence
  // either.
  const auto realism = normal_table({4, 4, 4, 4, 4}, 0.5, 2, 6, 11);
  const auto sickness = normal_table({1, 1, 1, 1, 1}, 0.2, 1, 6, 12, test::sickness_scale());
  const auto h2 = task1_hypotheses(realism, sickness, {}, "")[1];
  EXPECT_EQ(h2.status, HypothesisStatus::NotSupported) << h2.status_text;
  int silent = 0;
  for (const auto& test : h2.tests) silent += test.paper_holds ? 1 : 0;
  EXPECT_GE(silent, 7);
}

TEST(Hypotheses, ADifferenceBeyondTheMarginIsInferior) {
  const auto all = verdicts({2, 3, 5, 4.2, 5}, {1, 1, 0.5, 0.9, 0.5});
  EXPECT_EQ(all[2].status, HypothesisStatus::NotSupported) << all[2].status_text;
  EXPECT_FALSE(all[2].paper_supported);
  const auto within = verdicts({2, 3, 5, 4.85, 5}, {1, 1, 0.5, 0.55, 0.5});
  EXPECT_EQ(within[2].status, HypothesisStatus::Supported) << within[2].status_text;
}

TEST(Hypotheses, ASuperiorMethodIsNotInferior) {
  const auto h3 = verdicts({2, 3, 4, 6, 5}, {1, 1, 0.9, 0.2, 0.5})[2];
  EXPECT_EQ(h3.status, HypothesisStatus::Supported);
  EXPECT_TRUE(h3.paper_supported);
}

TEST(Hypotheses, TestsAreThoseOfTheTable) {
  const auto realism = normal_table({2, 3, 3.2, 3.1, 5}, 0.5, 1, 26, 21);
  const auto sickness = normal_table({1, 1, 0.9, 0.8, 0.5}, 0.2, 0.5, 26, 22, test::sickness_scale());
  const auto all = task1_hypotheses(realism, sickness, {}, "");
  const auto paired = t_test_paired(realism.column(1, 2), realism.column(1, 1));
  const HypothesisTest& h1 = all[0].tests[1];  // Ours - FovFluid, realism, 32k
  EXPECT_NEAR(*h1.p, paired->p, 1e-12);
  EXPECT_NEAR(*h1.t, paired->t, 1e-12);
  EXPECT_NEAR(*h1.d_z, paired->cohen_dz, 1e-12);
  EXPECT_NEAR((*h1.ci)[0], paired->ci[0], 1e-12);
  EXPECT_NEAR((*h1.ci)[1], paired->ci[1], 1e-12);
  const HypothesisTest& h2 = all[1].tests[4];  // Ours - HiRes, sickness, 16k
  const auto both = equivalence_paired(sickness.column(0, 2), sickness.column(0, 4), {-0.25, 0.25});
  EXPECT_NEAR(*h2.p, both->p, 1e-15);
  EXPECT_NEAR(*h2.paper_p, t_test_paired(sickness.column(0, 2), sickness.column(0, 4))->p, 1e-12);
  const HypothesisTest& h3 = all[2].tests[2];  // Ours-TSp - Ours, sickness, 16k: less is better
  const auto one =
      t_test_paired(sickness.column(0, 3), sickness.column(0, 2), {Alternative::Less, 0.95, 0.25});
  EXPECT_NEAR(*h3.p, one->p, 1e-12);
}

TEST(Hypotheses, HolmStaysWithinTheFamily) {
  const auto h1 = verdicts({2, 3, 3.2, 3.1, 5}, {1, 1, 0.98, 0.97, 0.5})[0];
  std::vector<double> p;
  for (const auto& test : h1.tests) p.push_back(*test.p);
  std::sort(p.begin(), p.end());
  double run = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    run = std::max(run, std::min(1.0, static_cast<double>(p.size() - i) * p[i]));
    EXPECT_TRUE(std::any_of(h1.tests.begin(), h1.tests.end(), [&](const HypothesisTest& test) {
      return *test.p == p[i] && std::abs(*test.p_holm - run) < 1e-14;
    }));
  }
}

/// Share of 1,000 studies of 26 people in which some test of a hypothesis rejects. Three standard errors of 5
/// % are 2.1 %.
template <class Rejects>
double share_of_studies(const std::vector<double>& realism, const std::vector<double>& sickness,
                        Rejects rejects) {
  constexpr int studies = 1000;
  int count = 0;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const auto all =
        task1_hypotheses(normal_table(realism, 0.5, 1.1, 26, 2 * study + 1),
                         normal_table(sickness, 0.2, 0.4, 26, 2 * study + 2, test::sickness_scale()), {}, "");
    count += rejects(all) ? 1 : 0;
  }
  return 1.0 * count / studies;
}

TEST(Hypotheses, AFamilyOfEightKeepsItsLevelWhereNothingDiffers) {
  int uncorrected = 0;
  const double share =
      share_of_studies({4, 4, 4, 4, 4}, {1, 1, 1, 1, 1}, [&](const std::vector<Hypothesis>& all) {
        const auto& tests = all[0].tests;
        uncorrected +=
            std::any_of(tests.begin(), tests.end(), [](const auto& test) { return *test.paper_p < 0.05; });
        return std::any_of(tests.begin(), tests.end(),
                           [](const auto& test) { return test.holds || test.against; });
      });
  EXPECT_NEAR(share, 0.05, 0.021);
  EXPECT_GT(uncorrected, 250) << "without correction every fourth study finds something";
}

TEST(Hypotheses, NonInferiorityKeepsItsLevelAtTheMargin) {
  // The accelerated strategy is worse by exactly the margin.
  const double share =
      share_of_studies({4, 4, 4, 3.5, 4}, {1, 1, 1, 1.25, 1},
                       [](const std::vector<Hypothesis>& all) { return all[2].confirmed > 0; });
  EXPECT_NEAR(share, 0.05, 0.021);
}

TEST(Hypotheses, WithoutTrackedGazeTheFirstIsNotTestable) {
  const auto all = verdicts({2, 3, 5, 5, 5}, {1.5, 1, 0.5, 0.5, 0.5}, 26, "gaze was not tracked");
  EXPECT_EQ(all[0].status, HypothesisStatus::NotTestable);
  EXPECT_EQ(all[0].status_if_testable, HypothesisStatus::Supported);
  EXPECT_THAT(all[0].status_text, HasSubstr("gaze was not tracked"));
  EXPECT_EQ(all[1].status, HypothesisStatus::Supported);
  EXPECT_EQ(all[2].status, HypothesisStatus::Supported);
}

TEST(Hypotheses, OnePersonIsNoData) {
  for (const auto& one : verdicts({2, 3, 5, 5, 5}, {1, 1, 1, 1, 1}, 1)) {
    EXPECT_EQ(one.status, HypothesisStatus::NoData);
    for (const auto& test : one.tests) EXPECT_THAT(test.reason, Not(IsEmpty()));
  }
}

TEST(Hypotheses, AMethodThatWasNotShownIsNamed) {
  std::vector<MethodScore> scores;
  for (int p = 0; p < 5; ++p) {
    scores.push_back({p, 0, 0, 0, 4.0 + 0.1 * p});
    scores.push_back({p, 0, 0, 1, 3.0 - 0.2 * p});
  }
  const ScoreTable realism(test::realism_scale(), scores, 5, {"16k"}, {"Ours", "FovFluid"});
  const ScoreTable sickness(test::sickness_scale(), scores, 5, {"16k"}, {"Ours", "FovFluid"});
  const auto all = task1_hypotheses(realism, sickness, {}, "");
  EXPECT_THAT(all[0].tests, SizeIs(4));
  EXPECT_THAT(all[0].tests[1].reason, HasSubstr("Ours-TSp"));
  EXPECT_EQ(all[1].status, HypothesisStatus::NoData);
}

/// H4 to H6 of ten pairs, each answered by 26 people; k of the first method named.
std::vector<Hypothesis> preferences(int tsp_over_ours, int ours_over_fov, int tsp_over_fov,
                                    int hires_over_ours, int hires_over_tsp,
                                    const std::string& untestable = "") {
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
  return task2_hypotheses(count_preferences(choices, 5, {}), test::methods, {}, untestable);
}

TEST(Hypotheses, ThePapersFigureTen) {
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
  // The paper calls H6 confirmed because nothing is significant; nothing is confirmed.
  EXPECT_TRUE(all[2].paper_supported);
  EXPECT_EQ(all[2].status, HypothesisStatus::NotSupported);
}

TEST(Hypotheses, ThePreferenceMustPointTheRightWay) {
  const auto all = preferences(3, 2, 3, 24, 23);
  EXPECT_EQ(all[0].status, HypothesisStatus::NotSupported);
  EXPECT_TRUE(all[0].tests[0].against);
  EXPECT_FALSE(all[0].paper_supported);
  EXPECT_EQ(all[1].status, HypothesisStatus::NotSupported);
  EXPECT_EQ(all[2].status, HypothesisStatus::Supported);
}

TEST(Hypotheses, TheLastIsOneSided) {
  // 18 of 26: two-sided p = .076, one-sided .038.
  const auto h6 = preferences(13, 13, 13, 18, 18)[2];
  EXPECT_NEAR(*h6.tests[0].p, 0.0378, 0.0005);
  EXPECT_NEAR(*h6.tests[0].paper_p, 0.0755, 0.0005);
  EXPECT_EQ(h6.status, HypothesisStatus::NotSupported) << "2 x .038 after Holm";
  EXPECT_EQ((*h6.tests[0].ci)[1], 1);
}

TEST(Hypotheses, WithoutTrackedGazeTheFifthIsNotTestable) {
  const auto all = preferences(22, 22, 22, 22, 22, "gaze was not tracked");
  EXPECT_EQ(all[0].status, HypothesisStatus::Supported);
  EXPECT_EQ(all[1].status, HypothesisStatus::NotTestable);
  EXPECT_EQ(all[1].status_if_testable, HypothesisStatus::Supported);
  EXPECT_EQ(all[2].status, HypothesisStatus::Supported);
}

TEST(Hypotheses, ARefusedPairCountsAsOneInItsFamily) {
  std::vector<PairChoice> choices;
  test::add_pair(choices, 1, 2, 5, 26);
  const auto h5 = task2_hypotheses(count_preferences(choices, 5, {}), test::methods, {}, "")[1];
  EXPECT_EQ(h5.status, HypothesisStatus::PartlySupported);
  EXPECT_NEAR(*h5.tests[0].p_holm, 2 * *h5.tests[0].p, 1e-15);
  EXPECT_THAT(h5.tests[1].reason, Not(IsEmpty()));
}

}  // namespace
}  // namespace stats
