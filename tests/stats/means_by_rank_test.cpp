/// Rank tests of means of whole answers against R on integer sums: tests/stats/r/means_by_rank.R.

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "stats/analysis/task1.hpp"
#include "stats/base/json.hpp"
#include "stats/inference/wilcoxon.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using json = base::Json;

json made_by_r() {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/means_by_rank.json");
  return json::parse(in);
}

ScoreTable table_of_study(const json& study) {
  std::vector<MethodScore> scores;
  for (const auto& report : study.at("reports"))
    scores.push_back({report[0], report[1], 0, report[2], report[3], study.at("items")});
  return {test::sickness_scale(), scores, study.at("people"), {"16k"}, {"A", "B", "C"}};
}

TEST(MeansByRank, PairedTestsAreThoseOfTheIntegerSums) {
  AnalysisPlan plan;
  plan.resamples = 100;
  int pairs = 0;
  const json made = made_by_r();
  for (const auto& study : made.at("studies")) {
    const auto analysis = analyse_scores(table_of_study(study), plan);
    for (std::size_t i = 0; i < 3; ++i, ++pairs) {
      const auto& want = study.at("pairs")[i];
      const std::string where = study.at("items").dump() + " items, " + want.dump();
      ASSERT_TRUE(analysis.comparisons[i].wilcoxon) << where;
      const auto& got = *analysis.comparisons[i].wilcoxon;
      EXPECT_EQ(got.n_nonzero, want.at("n_used")) << where;
      EXPECT_EQ(got.n - got.n_nonzero, want.at("n_zero")) << where;
      EXPECT_EQ(got.w_plus, want.at("v")) << where;
      EXPECT_NEAR(got.p_normal, want.at("p_normal"), 1e-13) << where;
      EXPECT_NEAR(got.p(), want.at("p_exact"), 1e-13) << where;
      EXPECT_NEAR(got.hodges_lehmann, want.at("location"), 1e-14) << where;
    }
    EXPECT_NEAR(analysis.omnibus[0].friedman->chi2, study.at("friedman").at("chi2"), 1e-11);
    EXPECT_NEAR(analysis.omnibus[0].friedman->p, study.at("friedman").at("p"), 1e-12);
  }
  EXPECT_EQ(pairs, 21);
}

TEST(ExactDifferences, LieOverOneDenominator) {
  const std::vector<ExactMean> x{{3, 3}, {4, 3}, {1, 7}, {}, {5, 2}}, y{{2, 3}, {6, 6}, {1, 7}, {1, 3}, {}};
  const auto got = exact_differences(x, y);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->denominator, 42);
  EXPECT_EQ(got->numerators, (std::vector<double>{14, 14, 0}));
  EXPECT_EQ(got->n_missing, 2u);
  EXPECT_EQ(got->values()[0], 1 / 3.0);
  EXPECT_EQ(signed_rank(*got)->w_plus, 3);
}

TEST(ExactDifferences, RefuseWhatDoublesCannotHold) {
  const std::vector<ExactMean> primes{{1, 1048573}, {1, 1048571}, {1, 1048559}}, ones(3, {1, 1});
  EXPECT_NE(exact_differences(primes, ones).reason().find("denominator"), std::string::npos);
  EXPECT_NE(exact_differences(std::vector<ExactMean>{{HUGE_VAL, 1}}, std::vector<ExactMean>{{1, 1}}).reason(),
            "");
  EXPECT_THROW(exact_differences(primes, std::vector<ExactMean>{{1, 1}}), std::invalid_argument);
  EXPECT_THROW(exact_differences(std::vector<ExactMean>{{1, 0}}, std::vector<ExactMean>{{1, 1}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace stats
