/// Linear mixed models against R's lme4 and lmerTest: tests/stats/r/mixed_model.R.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <vector>

#include "stats/analysis/mixed_scores.hpp"
#include "stats/base/json.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using json = base::Json;
using ::testing::HasSubstr;

json made_by_r() {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/mixed_model.json");
  return json::parse(in);
}

ScoreTable table_of_study(const json& study) {
  std::vector<MethodScore> scores;
  for (const auto& answer : study.at("answers"))
    scores.push_back(
        {answer[0], answer[1], answer[2], answer[3], answer[4], study.at("items"), answer[5], answer[6]});
  int participants = 0;
  for (const auto& score : scores) participants = std::max(participants, score.participant + 1);
  return {test::realism_scale(), scores, participants, test::n_stars, test::methods};
}

/// Compares estimate, se, df, t, interval and p. Values that may be zero have tolerances in units of se.
void expect_like(const MixedContrast& got, const json& want, const std::string& where) {
  const double se = want[1];
  EXPECT_NEAR(got.estimate, want[0], 2e-6 * se) << where;
  EXPECT_NEAR(got.se, want[1], 2e-6 * se) << where;
  EXPECT_NEAR(got.df, want[2], 2e-5 * want[2].get<double>()) << where;
  EXPECT_NEAR(got.t, want[3], 1e-5) << where;
  EXPECT_NEAR(got.ci[0], want[4], 1e-5 * se) << where;
  EXPECT_NEAR(got.ci[1], want[5], 1e-5 * se) << where;
  EXPECT_NEAR(got.p, want[6], 1e-5 * want[6].get<double>()) << where;
}

TEST(MixedModel, AgreesWithLmerTest) {
  const json made = made_by_r();
  ASSERT_EQ(made.at("studies").size(), 6u);
  for (const auto& study : made.at("studies")) {
    const std::string name = study.at("name");
    const auto model = fit_mixed_scores(table_of_study(study));
    ASSERT_TRUE(model) << name << ": " << model.reason();
    const auto& fit = model->fit;
    EXPECT_NEAR(fit.criterion, study.at("criterion"), 1e-7) << name;
    EXPECT_NEAR(fit.sd_participant, study.at("sd").at("person"), 1e-5) << name;
    EXPECT_NEAR(fit.sd_residual, study.at("sd").at("residual"), 1e-5) << name;
    EXPECT_EQ(fit.sd_thing.has_value(), !study.at("sd").at("method").is_null()) << name;
    if (fit.sd_thing) {
      EXPECT_NEAR(*fit.sd_thing, study.at("sd").at("method"), 1e-5) << name;
    }
    EXPECT_EQ(!fit.singular.empty(), study.at("singular").get<bool>()) << name;
    for (const auto& one : study.at("tests")) {
      const auto got = model->difference(one.at("n_star"), one.at("a"), one.at("b"), 0.95);
      ASSERT_TRUE(got) << name << ": " << got.reason();
      expect_like(*got, one.at("test"), name + ", " + one.dump());
    }
    for (const auto& [term, want] : study.at("others").items()) {
      ASSERT_GE(fit.index_of(term), 0) << name << ": " << term;
      std::vector<double> weights(fit.beta.size());
      weights[static_cast<std::size_t>(fit.index_of(term))] = 1;
      expect_like(fit.contrast(weights), want, name + ", " + term);
    }
  }
}

TEST(MixedModel, SaysWhichSpreadIsNought) {
  const json made = made_by_r();
  const auto singular = [&](std::size_t study) {
    return fit_mixed_scores(table_of_study(made.at("studies")[study]))->fit.singular;
  };
  EXPECT_EQ(singular(0), "");
  EXPECT_EQ(singular(3), "participants do not differ by method");
  EXPECT_EQ(singular(4), "participants do not differ in level");
}

// For a complete table with one answer in each cell, the model's differences equal those of the means.
TEST(MixedModel, CompleteDataGiveThePairedDifferences) {
  const auto table = test::normal_table({3, 4, 5, 5, 6}, 1, 0.7, 12, 5);
  const auto model = fit_mixed_scores(table);
  ASSERT_TRUE(model) << model.reason();
  double mean = 0;
  for (std::size_t p = 0; p < 12; ++p) mean += (table.column(1, 4)[p] - table.column(1, 0)[p]) / 12;
  EXPECT_NEAR(model->difference(1, 4, 0, 0.95)->estimate, mean, 1e-9);
}

// A predictor that is a linear combination of others is left out, without effect on the other predictors.
TEST(MixedModel, LeavesOutTermsThatOthersMakeUp) {
  std::vector<MethodScore> scores;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  for (int p = 0; p < 10; ++p) {
    const double level = normal(generator);
    for (int at = 0; at < 4; ++at)
      scores.push_back({p, at / 2, at / 2, at % 2, level + normal(generator), 1});
  }
  const ScoreTable table{test::realism_scale(), scores, 10, test::n_stars, {"A", "B"}};
  const auto model = fit_mixed_scores(table);
  ASSERT_TRUE(model) << model.reason();
  EXPECT_EQ(model->fit.left_out, (std::vector<std::string>{"scene1", "position"}));
}

TEST(MixedModel, RefusesWhatHasNoAnswer) {
  const auto reason = [](std::vector<MethodScore> scores, int participants) {
    return fit_mixed_scores({test::realism_scale(), scores, participants, test::n_stars, test::methods})
        .reason();
  };
  EXPECT_THAT(reason({}, 0), HasSubstr("fewer than two participants"));
  EXPECT_THAT(reason({{0, 0, 0, 0, 3}, {0, 0, 0, 1, 4}}, 1), HasSubstr("fewer than two participants"));
  EXPECT_THAT(reason({{0, 0, 0, 0, 3}, {1, 0, 0, 1, 4}}, 2), HasSubstr("no participant gave two answers"));
  EXPECT_THAT(reason({{0, 0, 0, 0, 3}, {1, 0, 0, 1, 4}, {1, 0, 0, 3, 4}, {0, 0, 0, 2, 1}}, 2),
              HasSubstr("no more answers"));
  std::vector<MethodScore> equal;
  for (int p = 0; p < 6; ++p) {
    for (int m = 0; m < 5; ++m) equal.push_back({p, 0, 0, m, 4});
  }
  EXPECT_THAT(reason(equal, 6), HasSubstr("no scatter"));
}

TEST(MixedModel, APairThatNobodyJudgedIsRefused) {
  const auto table = test::table_of({{1, 2}, {2, 4}, {3, 3}, {2, 5}}, {"A", "B", "C"});
  const auto model = fit_mixed_scores(table);
  ASSERT_TRUE(model) << model.reason();
  EXPECT_TRUE(model->difference(0, 0, 1, 0.95));
  EXPECT_THAT(model->difference(0, 0, 2, 0.95).reason(), HasSubstr("no answer"));
}

TEST(MixedModel, PeriodsAreRunsOfBlocks) {
  EXPECT_EQ(periods_of(std::vector{7, 7, 3, 3, 3}), (std::vector{0, 0, 1, 1, 1}));
  EXPECT_EQ(periods_of(std::vector{7, 3, 7}), (std::vector{0, 0, 0}));
  EXPECT_TRUE(periods_of({}).empty());
}

}  // namespace
}  // namespace stats
