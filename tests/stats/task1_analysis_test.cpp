#include "stats/analysis/task1.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using test::table_of;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Two-sided p of Student's t with 3 degrees of freedom, in closed form.
double p_of_t3(double t) {
  const double x = std::abs(t) / std::sqrt(3.0);
  return 1 - 2 / std::numbers::pi * (x / (1 + x * x) + std::atan(x));
}

AnalysisPlan quick_plan() {
  AnalysisPlan plan;
  plan.resamples = 400;
  return plan;
}

TEST(ScoreTable, ScenesAreAveragedWithinParticipantBaselineAndMethod) {
  const std::vector<MethodScore> scores{{0, 0, 0, 0, 3}, {0, 1, 0, 0, 6},       {0, 0, 1, 0, 7},
                                        {1, 2, 0, 0, 2}, {1, 2, 0, 1, missing}, {0, 2, 0, 0, missing}};
  const ScoreTable table(test::realism_scale(), scores, 2, test::n_stars, {"A", "B"});
  EXPECT_THAT(table.column(0, 0), ElementsAre(4.5, 2));
  EXPECT_EQ(table.column(1, 0)[0], 7);
  EXPECT_TRUE(std::isnan(table.column(1, 0)[1]));
  EXPECT_TRUE(std::isnan(table.column(0, 1)[1])) << "a missing answer is no zero";
  EXPECT_THAT(table.rows(1), SizeIs(2)) << "who gave nothing at this n_* has no row";
}

TEST(ScoreTable, KeepsTheSumsOfItems) {
  // Means of three items: (1 + 2 + 0) / 9 over three reports and 1 / 3 over one are the same number.
  const std::vector<MethodScore> scores{
      {0, 0, 0, 0, 1, 3}, {0, 1, 0, 0, 2, 3}, {0, 2, 0, 0, 0, 3}, {0, 0, 0, 1, 1, 3}};
  const ScoreTable table(test::realism_scale(), scores, 1, {"16k"}, {"A", "B"});
  EXPECT_EQ(table.means(0, 0)[0].sum, 3);
  EXPECT_EQ(table.means(0, 0)[0].count, 9);
  EXPECT_EQ(table.column(0, 0)[0], table.column(0, 1)[0]);
}

TEST(ScoreTable, IndicesOutsideAreProgrammingErrors) {
  const std::vector<MethodScore> outside{{2, 0, 0, 0, 3}};
  EXPECT_THROW(ScoreTable(test::realism_scale(), outside, 2, {"16k"}, {"A"}), std::invalid_argument);
  const std::vector<MethodScore> mixed{{0, 0, 0, 0, 3, 3}, {1, 0, 0, 0, 3, 4}};
  EXPECT_THROW(ScoreTable(test::realism_scale(), mixed, 2, {"16k"}, {"A"}), std::invalid_argument);
}

TEST(Task1, PairedTestByHand) {
  // Differences 2, 1, 3, 0: mean 3/2, variance 5/3.
  const auto table = table_of({{5, 3}, {6, 5}, {7, 4}, {4, 4}}, {"A", "B"});
  const auto analysis = analyse_scores(table, quick_plan());
  ASSERT_THAT(analysis.comparisons, SizeIs(1));
  const MethodComparison& one = analysis.comparisons[0];
  const double t = 1.5 / std::sqrt(5.0 / 3 / 4);
  ASSERT_TRUE(one.t);
  EXPECT_NEAR(one.t->t, t, 1e-12);
  EXPECT_EQ(one.t->df, 3);
  EXPECT_NEAR(one.t->p, p_of_t3(t), 1e-12);
  EXPECT_NEAR(one.t->cohen_dz, 1.5 / std::sqrt(5.0 / 3), 1e-12);
  EXPECT_EQ(one.n, 4u);
  EXPECT_EQ(one.n_missing, 0u);
  EXPECT_NEAR(*one.mean_a, 5.5, 1e-15);
  EXPECT_NEAR(*one.p_holm, one.t->p, 1e-15) << "a family of one";
  // Wilcoxon: ranks 2, 1, 3 of the differences 2, 1, 3, without the zero; exact two-sided p 2 / 2^3.
  ASSERT_TRUE(one.wilcoxon);
  EXPECT_EQ(one.wilcoxon->w_plus, 6);
  EXPECT_NEAR(*one.wilcoxon->p_exact, 0.25, 1e-12);
  // Upper one-sided test: t = (1.5 - 0.5) / se, not equivalent.
  ASSERT_TRUE(one.equivalence);
  EXPECT_NEAR(one.equivalence->p, 1 - p_of_t3(1 / std::sqrt(5.0 / 12)) / 2, 1e-12);
}

TEST(Task1, MissingMethodsCostOnlyTheirPairs) {
  const auto table = table_of({{5, 3, 4}, {6, missing, 5}, {7, 4, 3}, {missing, 5, 6}}, {"A", "B", "C"});
  const auto analysis = analyse_scores(table, quick_plan());
  ASSERT_THAT(analysis.comparisons, SizeIs(3));
  EXPECT_EQ(analysis.comparisons[0].n, 2u);  // A, B
  EXPECT_EQ(analysis.comparisons[0].n_missing, 2u);
  EXPECT_EQ(analysis.comparisons[1].n, 3u);  // A, C
  EXPECT_EQ(analysis.comparisons[2].n, 3u);  // B, C
  EXPECT_EQ(analysis.omnibus[0].n, 2);
  EXPECT_EQ(analysis.omnibus[0].n_incomplete, 2);
}

TEST(Task1, HolmCountsRefusedTestsInItsFamily) {
  // Only one person saw B: its two tests are refused, but the test of A against C is still corrected over
  // three.
  const auto table =
      table_of({{5, missing, 4}, {6, 6, 4}, {7, missing, 4}, {4, missing, 3}}, {"A", "B", "C"});
  const auto analysis = analyse_scores(table, quick_plan());
  const auto& alone = analysis.comparisons[0];
  EXPECT_FALSE(alone.t);
  EXPECT_THAT(alone.t.reason(), ::testing::Not(::testing::IsEmpty()));
  EXPECT_FALSE(alone.p().has_value());
  EXPECT_FALSE(alone.p_holm.has_value());
  const auto& other = analysis.comparisons[1];
  EXPECT_NEAR(*other.p_holm, std::min(1.0, 3 * other.t->p), 1e-14);
  EXPECT_NEAR(*other.p_bh, std::min(1.0, 3 * other.t->p), 1e-14);
}

// Earlier versions reported "no data", although everybody agreed.
TEST(Task1, DifferencesWithoutSpreadAreTestedBySign) {
  const auto table = table_of({{5, 5, 4}, {6, 6, 5}, {7, 7, 6}, {4, 4, 3}}, {"A", "B", "C"});
  const auto analysis = analyse_scores(table, quick_plan());
  const auto& equal = analysis.comparisons[0];
  const auto& apart = analysis.comparisons[1];
  EXPECT_FALSE(equal.t);
  EXPECT_EQ(*equal.p(), 1);
  EXPECT_FALSE(apart.t);
  EXPECT_EQ(apart.unanimous->value, 1);
  EXPECT_EQ(*apart.p(), 0.125) << "four of four on one side";
  EXPECT_EQ(*apart.p_holm, 0.375);
}

TEST(Task1, OneParticipantHasMeansAndNoTests) {
  const auto analysis = analyse_scores(table_of({{5, 3}}, {"A", "B"}), quick_plan());
  EXPECT_FALSE(analysis.comparisons[0].t);
  EXPECT_FALSE(analysis.omnibus[0].friedman);
  EXPECT_EQ(analysis.cells[0].summary->mean, 5);
  EXPECT_FALSE(analysis.cells[0].mean);
}

TEST(Task1, AMethodNobodySawHasNamedReasons) {
  const auto analysis =
      analyse_scores(table_of({{5, missing}, {4, missing}, {3, missing}}, {"A", "B"}), quick_plan());
  EXPECT_FALSE(analysis.cells[1].summary);
  EXPECT_EQ(analysis.comparisons[0].n, 0u);
  EXPECT_FALSE(analysis.comparisons[0].t);
  EXPECT_FALSE(analysis.comparisons[0].mean_a.has_value());
  EXPECT_FALSE(analysis.omnibus[0].anova);
}

TEST(Task1, OutliersAreListedNotDropped) {
  std::vector<std::vector<double>> rows;
  for (const double value : {4.0, 4.5, 5.0, 4.2, 4.8, 4.4, 1.0}) rows.push_back({value, 4});
  const auto analysis = analyse_scores(table_of(rows, {"A", "B"}), quick_plan());
  EXPECT_THAT(analysis.cells[0].outliers, ElementsAre(1.0));
  EXPECT_THAT(analysis.cells[0].values, SizeIs(7));
}

TEST(Task1, SwappingMethodsSwapsSignsAndKeepsP) {
  const auto forwards = analyse_scores(table_of({{5, 3}, {6, 5}, {7, 4}, {4, 4}}, {"A", "B"}), quick_plan());
  const auto backwards = analyse_scores(table_of({{3, 5}, {5, 6}, {4, 7}, {4, 4}}, {"B", "A"}), quick_plan());
  const auto &one = forwards.comparisons[0], &other = backwards.comparisons[0];
  EXPECT_NEAR(one.t->estimate, -other.t->estimate, 1e-15);
  EXPECT_NEAR(one.t->p, other.t->p, 1e-14);
  EXPECT_NEAR(one.wilcoxon->p(), other.wilcoxon->p(), 1e-14);
  EXPECT_NEAR(one.equivalence->p, other.equivalence->p, 1e-14);
}

/// Share of 1,000 studies without a true difference in which the paired t test of two methods gives p < .05.
/// Each participant has a preference of their own, and sees two blocks with one number of particles.
/// `averaged`: a participant's two blocks make one row of the table, otherwise two rows, as if two people had
/// seen them.
double false_alarms(bool averaged) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  int alarms = 0;
  constexpr int studies = 1000, people = 13;
  for (int study = 0; study < studies; ++study) {
    std::vector<MethodScore> scores;
    for (int p = 0; p < people; ++p) {
      const double leaning = normal(generator);
      for (int block = 0; block < 2; ++block) {
        const int unit = averaged ? p : 2 * p + block;
        scores.push_back({unit, block, 0, 0, normal(generator) + leaning});
        scores.push_back({unit, block, 0, 1, normal(generator)});
      }
    }
    const ScoreTable table(test::realism_scale(), scores, averaged ? people : 2 * people, {"16k"},
                           {"A", "B"});
    const auto test = t_test_paired(table.column(0, 0), table.column(0, 1));
    alarms += test->p < 0.05 ? 1 : 0;
  }
  return 1.0 * alarms / studies;
}

TEST(Task1, AveragingScenesKeepsTheLevelAndPoolingDoesNot) {
  // Three standard errors of a share of 5 % in 1,000 studies are 2.1 %.
  EXPECT_NEAR(false_alarms(true), 0.05, 0.021);
  EXPECT_GT(false_alarms(false), 0.075);
}

}  // namespace
}  // namespace stats
