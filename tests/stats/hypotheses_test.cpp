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

/// `realism` and `sickness` are means in the order LoRes, FovFluid, Ours, Ours-TSp, HiRes.
std::vector<Hypothesis> verdicts(const std::vector<double>& realism, const std::vector<double>& sickness,
                                 int n = 26, const std::string& untestable = "",
                                 const AnalysisPlan& plan = {}) {
  return task1_hypotheses(normal_table(realism, 0.5, noise, n, 3),
                          normal_table(sickness, 0.2, noise / 4, n, 103, test::sickness_scale()), plan,
                          untestable);
}

AnalysisPlan one_sided_throughout() {
  AnalysisPlan plan;
  plan.directional = Directional::All;
  return plan;
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
  // FovFluid looks better but sickens more, so only sickness supports the claim.
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
  // The paper's rule takes a missing difference for equality: six noisy people show neither a difference nor
  // equivalence.
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
  EXPECT_NEAR(*h2.p, std::min(1.0, 2 * both->p), 1e-15) << "two-sided, as all";
  EXPECT_NEAR(*h2.paper_p, t_test_paired(sickness.column(0, 2), sickness.column(0, 4))->p, 1e-12);
  const HypothesisTest& h3 = all[2].tests[2];  // Ours-TSp - Ours, sickness, 16k: less is better
  const auto against_margin = [&](Alternative side) {
    return t_test_paired(sickness.column(0, 3), sickness.column(0, 2), {side, 0.95, 0.25})->p;
  };
  EXPECT_NEAR(*h3.p, against_margin(Alternative::TwoSided), 1e-12);
  const auto sided = task1_hypotheses(realism, sickness, one_sided_throughout(), "");
  AnalysisPlan strict;
  strict.alpha = 0.01;
  for (const auto& hypothesis : task1_hypotheses(realism, sickness, strict, ""))
    for (const auto& test : hypothesis.tests) EXPECT_DOUBLE_EQ(test.ci_confidence, 0.99) << hypothesis.id;
  EXPECT_NEAR(*sided[0].tests[1].p,
              t_test_paired(realism.column(1, 2), realism.column(1, 1), {Alternative::Greater, 0.95, 0})->p,
              1e-12);
  EXPECT_NEAR(*sided[1].tests[4].p, both->p, 1e-15);
  EXPECT_NEAR(*sided[2].tests[2].p, against_margin(Alternative::Less), 1e-12);
}

/// True if the test's confidence interval lies wholly on the side of zero, of the margin or of one half, or
/// wholly between the margins, that the claim needs.
bool interval_holds(const Hypothesis& hypothesis, const HypothesisTest& test) {
  const auto [low, high] = *test.ci;
  const bool more = test.score != "sickness";
  switch (hypothesis.kind) {
    case HypothesisKind::Superiority:
      return more ? low > 0 : high < 0;
    case HypothesisKind::Equivalence:
      return low > -*test.margin && high < *test.margin;
    case HypothesisKind::NonInferiority:
      return more ? low > -*test.margin : high < *test.margin;
    case HypothesisKind::Preference:
      break;
  }
  return low > 0.5;
}

// If all six hypotheses are tested two-sided, the interval of 1 - alpha decides each test; if all are tested
// one-sided, that of 1 - 2 alpha.
TEST(Hypotheses, TheIntervalShownDecidesEachTestAlike) {
  for (const AnalysisPlan& plan : {AnalysisPlan{}, one_sided_throughout()}) {
    int holding = 0, tests = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      for (const auto& one : task1_hypotheses(
               normal_table({3, 3.4, 3.9, 3.8, 4}, 0.5, 0.9, 20, seed),
               normal_table({1, 0.9, 0.7, 0.75, 0.6}, 0.2, 0.4, 20, seed + 999, test::sickness_scale()), plan,
               "")) {
        EXPECT_EQ(one.one_sided, plan.directional == Directional::All);
        for (const auto& test : one.tests) {
          EXPECT_EQ(test.holds_alone, interval_holds(one, test)) << test.label << ", p = " << *test.p;
          EXPECT_EQ(test.ci_confidence, one.one_sided ? 0.9 : 0.95);
          holding += test.holds_alone ? 1 : 0;
          ++tests;
        }
      }
    }
    EXPECT_GT(holding, tests / 10);
    EXPECT_LT(holding, 9 * tests / 10);
  }
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

/// Share of 1,000 studies of 26 people in which a test of a hypothesis rejects. Three standard errors of 5 %
/// are 2.1 %.
template <class Rejects>
double share_of_studies(const std::vector<double>& realism, const std::vector<double>& sickness,
                        const AnalysisPlan& plan, Rejects rejects) {
  constexpr int studies = 1000;
  int count = 0;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const auto all = task1_hypotheses(
        normal_table(realism, 0.5, 1.1, 26, 2 * study + 1),
        normal_table(sickness, 0.2, 0.4, 26, 2 * study + 2, test::sickness_scale()), plan, "");
    count += rejects(all) ? 1 : 0;
  }
  return 1.0 * count / studies;
}

TEST(Hypotheses, AFamilyOfEightKeepsItsLevelWhereNothingDiffers) {
  int uncorrected = 0;
  const double share =
      share_of_studies({4, 4, 4, 4, 4}, {1, 1, 1, 1, 1}, {}, [&](const std::vector<Hypothesis>& all) {
        const auto& tests = all[0].tests;
        uncorrected +=
            std::any_of(tests.begin(), tests.end(), [](const auto& test) { return *test.paper_p < 0.05; });
        return std::any_of(tests.begin(), tests.end(),
                           [](const auto& test) { return test.holds_holm || test.against; });
      });
  EXPECT_NEAR(share, 0.05, 0.021);
  EXPECT_GT(uncorrected, 250) << "without correction every fourth study finds something";
}

TEST(Hypotheses, NonInferiorityKeepsItsLevelAtTheMargin) {
  // Ours-TSp is worse than Ours by exactly the margin.
  const double share =
      share_of_studies({4, 4, 4, 3.5, 4}, {1, 1, 1, 1.25, 1}, one_sided_throughout(),
                       [](const std::vector<Hypothesis>& all) { return all[2].confirmed_holm > 0; });
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

/// Person p rates a method with its mean plus p % 3, so the differences between methods are the same for all.
std::vector<Hypothesis> unanimous_verdicts(const std::vector<double>& realism,
                                           const std::vector<double>& sickness, int n,
                                           const AnalysisPlan& plan = {}) {
  const auto table = [&](const std::vector<double>& means, ScoreScale scale) {
    std::vector<MethodScore> scores;
    for (int p = 0; p < n; ++p)
      for (int block = 0; block < 2; ++block)
        for (int m = 0; m < 5; ++m)
          scores.push_back({p, block, block, m, means[static_cast<std::size_t>(m)] + p % 3});
    return ScoreTable(std::move(scale), scores, n, test::n_stars, test::methods);
  };
  return task1_hypotheses(table(realism, test::realism_scale()), table(sickness, test::sickness_scale()),
                          plan, "");
}

TEST(Hypotheses, UnanimousDifferencesAreTestedBySign) {
  const auto all = unanimous_verdicts({1, 2, 4, 4, 4}, {2, 1, 0, 0, 0}, 8);
  for (const auto& one : all) {
    EXPECT_EQ(one.status, HypothesisStatus::Supported) << one.status_text;
    for (const auto& test : one.tests) {
      EXPECT_EQ(test.method, "exact sign test");
      EXPECT_EQ(*test.p, std::ldexp(1, -7)) << test.label << ": all eight on one side, both sides counted";
      EXPECT_THAT(test.reason, IsEmpty());
      EXPECT_FALSE(test.ci.has_value());
    }
  }
  EXPECT_EQ(*all[0].tests[0].estimate, 2);
  for (const auto& one : unanimous_verdicts({1, 2, 4, 4, 4}, {2, 1, 0, 0, 0}, 8, one_sided_throughout()))
    for (const auto& test : one.tests) EXPECT_EQ(*test.p, std::ldexp(1, -8)) << test.label;
}

TEST(Hypotheses, UnanimousDifferencesThatSpeakForNothingHoldNothing) {
  // Ours equals FovFluid. HiRes differs from Ours by more than the margin. Ours-TSp is worse than Ours by
  // exactly the margin.
  const auto all = unanimous_verdicts({1, 2, 2, 1.5, 3}, {2, 1, 1, 1.25, 0}, 12);
  EXPECT_EQ(*all[0].tests[0].p, 1) << "no difference at all";
  EXPECT_EQ(*all[0].tests[2].p, std::ldexp(1, -11));
  EXPECT_TRUE(all[0].tests[2].against);
  EXPECT_EQ(*all[1].tests[0].p, 1) << "beyond the margin";
  EXPECT_EQ(*all[2].tests[0].p, 1) << "at the margin";
  for (const auto& one : all) EXPECT_EQ(one.confirmed, 0);
  // Five people show nothing with a sign test: its smallest two-sided p is 2^-4.
  for (const auto& one : unanimous_verdicts({1, 2, 4, 4, 4}, {2, 1, 0, 0, 0}, 5))
    EXPECT_EQ(one.status, HypothesisStatus::NotSupported) << one.status_text;
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

}  // namespace
}  // namespace stats
