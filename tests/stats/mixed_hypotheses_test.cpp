/// H1 to H3 (hypotheses about the realism and sickness of methods) by the mixed model: against lmerTest
/// (tests/stats/r/mixed_hypotheses.R), by hand, and beside the paired tests.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <vector>

#include "stats/analysis/hypotheses.hpp"
#include "stats/base/json.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using json = base::Json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

json made_by_r(const std::string& file) {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/" + file);
  return json::parse(in);
}

AnalysisPlan by_model(Directional directional = Directional::None) {
  AnalysisPlan plan;
  plan.tests = ScoreTests::Mixed;
  plan.directional = directional;
  return plan;
}

/// The answers of a study in mixed_model.json, used as realism and as sickness.
std::vector<Hypothesis> judged(const json& study, const AnalysisPlan& plan) {
  std::vector<MethodScore> scores;
  int participants = 0;
  for (const auto& answer : study.at("answers")) {
    scores.push_back(
        {answer[0], answer[1], answer[2], answer[3], answer[4], study.at("items"), answer[5], answer[6]});
    participants = std::max(participants, scores.back().participant + 1);
  }
  const auto table = [&](ScoreScale scale) {
    return ScoreTable(std::move(scale), scores, participants, test::n_stars, test::methods);
  };
  return task1_hypotheses(table(test::realism_scale()), table(test::sickness_scale()), plan, "");
}

const HypothesisTest& test_named(const std::vector<Hypothesis>& all, const std::string& id,
                                 const std::string& label) {
  const auto& tests =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.id == id; })->tests;
  return *std::find_if(tests.begin(), tests.end(), [&](const auto& one) { return one.label == label; });
}

TEST(MixedHypotheses, TestsAreThoseOfLmerTest) {
  const json studies = made_by_r("mixed_model.json").at("studies"), made = made_by_r("mixed_hypotheses.json");
  std::vector<std::vector<Hypothesis>> verdicts;
  for (const auto& study : studies) {
    verdicts.push_back(judged(study, by_model()));
    verdicts.push_back(judged(study, by_model(Directional::All)));
  }
  ASSERT_EQ(made.at("tests").size(), 20u * 2 * 5 + 10u * 2) << "five studies of two n_*, one of one";
  for (const json& want : made.at("tests")) {
    const std::size_t sided = want.at("one_sided").get<bool>() ? 1 : 0;
    const auto& all = verdicts[2 * want.at("study").get<std::size_t>() + sided];
    const HypothesisTest& got = test_named(all, want.at("id"), want.at("label"));
    const double se = *got.se, p = want.at("p");
    EXPECT_EQ(got.method, "t test of the mixed model");
    EXPECT_NEAR(*got.estimate, want.at("estimate"), 2e-6 * se) << want;
    EXPECT_NEAR(*got.df, want.at("df"), 2e-5 * want.at("df").get<double>()) << want;
    EXPECT_NEAR(*got.t, want.at("t"), 2e-5) << want;
    EXPECT_NEAR(*got.p, p, 1e-4 * p) << want;
    EXPECT_NEAR((*got.ci)[0], want.at("ci")[0], 1e-5 * se) << want;
    EXPECT_NEAR((*got.ci)[1], want.at("ci")[1], 1e-5 * se) << want;
    EXPECT_EQ(got.holds, want.at("holds").get<bool>()) << want;
    EXPECT_FALSE(got.d_z);
  }
}

// For two methods that everybody judges once, the model's test is the paired one. The differences 1, 2, 3, 2,
// 2 have mean 2 and error sqrt(0.5 / 5); the spread of people's levels exceeds that of the differences.
TEST(MixedHypotheses, CompletePairsGiveThePairedTest) {
  const auto table = [](ScoreScale scale) {
    return test::table_of({{2, 1}, {4, 2}, {6, 3}, {7, 5}, {9, 7}}, {"Ours", "FovFluid"}, std::move(scale));
  };
  const auto h1 =
      task1_hypotheses(table(test::realism_scale()), table(test::sickness_scale()), by_model(), "")[0];
  const HypothesisTest& got = h1.tests[0];
  EXPECT_NEAR(*got.estimate, 2, 1e-9);
  EXPECT_NEAR(*got.t, 2 / std::sqrt(0.1), 1e-5);
  EXPECT_NEAR(*got.df, 4, 1e-4);
  // Student's upper tail with 4 degrees of freedom: 1/2 - (3 s - s^3) / 4 with s = t / sqrt(t^2 + 4).
  const double s = std::sqrt(40.0 / 44);
  EXPECT_NEAR(*got.p, 1 - (3 * s - s * s * s) / 2, 1e-7);
  EXPECT_EQ(got.n, 5u);
  EXPECT_TRUE(got.holds);
  EXPECT_THAT(h1.tests[1].reason, HasSubstr("does not show Ours-TSp"));
  EXPECT_THAT(h1.rule, HasSubstr("t tests of the mixed model, two-sided"));
}

// The study "half left" of mixed_model.R: the tests of the mixed model use the answers of people who left
// early, the paired tests do not. The plan's key decides which tests count; the others are reported beside
// them.
TEST(MixedHypotheses, TheKeyDecidesAndTheOtherStandsBeside) {
  const json study = made_by_r("mixed_model.json").at("studies")[1];
  const auto mixed = judged(study, by_model()), paired = judged(study, {});
  std::set<int> people;
  for (const auto& answer : study.at("answers")) people.insert(answer[0].get<int>());
  int differ = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(mixed[i].paired);
    EXPECT_FALSE(paired[i].paired);
    EXPECT_EQ(mixed[i].paired->status, paired[i].status);
    EXPECT_EQ(mixed[i].paired->confirmed, paired[i].confirmed);
    EXPECT_EQ(mixed[i].paper_text, paired[i].paper_text) << "the paper's rule is of paired tests";
    for (std::size_t k = 0; k < mixed[i].tests.size(); ++k) {
      const auto &one = mixed[i].tests[k], &other = paired[i].tests[k], &beside = mixed[i].paired->tests[k];
      EXPECT_EQ(one.label, other.label);
      EXPECT_EQ(other.method, "paired t test");
      EXPECT_EQ(beside.p, other.p);
      EXPECT_EQ(one.paper_p, other.paper_p);
      EXPECT_EQ(one.n, people.size()) << "all of the model";
      EXPECT_LT(other.n, people.size());
      differ += one.holds != other.holds ? 1 : 0;
    }
  }
  EXPECT_GT(differ, 0);
}

TEST(MixedHypotheses, AModelThatCannotBeFittedGivesReasons) {
  std::vector<MethodScore> scores;
  for (int p = 0; p < 8; ++p)
    for (int block = 0; block < 2; ++block)
      for (int m = 0; m < 5; ++m) scores.push_back({p, block, block, m, m < 2 ? 1.0 : 3.0});
  const auto table = [&](ScoreScale scale) {
    return ScoreTable(std::move(scale), scores, 8, test::n_stars, test::methods);
  };
  for (const auto& one :
       task1_hypotheses(table(test::realism_scale()), table(test::sickness_scale()), by_model(), "")) {
    EXPECT_EQ(one.status, HypothesisStatus::NoData) << one.status_text;
    for (const auto& test : one.tests) {
      EXPECT_FALSE(test.p);
      EXPECT_THAT(test.reason, StartsWith("no mixed model: "));
    }
    EXPECT_EQ(one.paired->tests[0].method, "exact sign test");
  }
}

}  // namespace
}  // namespace stats
