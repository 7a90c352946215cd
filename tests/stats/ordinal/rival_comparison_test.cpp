/// Comparison of rival models over people, against R (tests/stats/r/rival_models.R).

#include "stats/ordinal/rival_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/stats/ordinal/rival_oracle.hpp"

namespace {

using rival_oracle::data_of;
using stats::RivalVerdict;

std::vector<double> doubles(const base::Json& list) {
  std::vector<double> out;
  for (const auto& item : list) out.push_back(item);
  return out;
}

struct Study {
  rival_oracle::Data data;
  std::vector<stats::RivalModel> models;

  Study() : data(data_of(rival_oracle::all().at("cross_validation").at("data"))) {
    models = {data.model({0, 1}), data.model({0}), data.model({1})};
    models[0].name = "ptpe";
    models[1].name = "rate";
    models[2].name = "delta";
  }
};

TEST(RivalComparison, ScoresOfPeopleLeftOutAreThoseOfBruteForce) {
  const Study study;
  stats::RivalComparisonOptions options;
  options.fit.points = 25;
  const auto result = stats::compare_rivals(study.models, study.data.answers, -1, options);
  ASSERT_TRUE(result) << result.reason();
  const auto want = rival_oracle::all().at("cross_validation");
  for (const auto& model : result->models) {
    const auto scores = doubles(want.at(model.name));
    double total = 0;
    for (std::size_t p = 0; p < scores.size(); ++p) {
      EXPECT_NEAR(model.by_person[p], scores[p], 1e-3) << model.name << p;
      total += model.by_person[p];
    }
    EXPECT_DOUBLE_EQ(model.total, total);
  }
}

TEST(RivalComparison, DifferencesArePairedOverPeople) {
  const auto lead =
      stats::rival_lead(std::vector<double>{-3, -5, -4, -8}, std::vector<double>{-4, -7, -4, -9});
  EXPECT_DOUBLE_EQ(lead.difference, 4);
  EXPECT_NEAR(lead.se, std::sqrt(4 * (0.0 + 1 + 1 + 0) / 3), 1e-12);
  EXPECT_FALSE(lead.leads()) << "4 is no more than least_lead";
  EXPECT_TRUE((stats::RivalLead{9, 4}.leads()));
  EXPECT_FALSE((stats::RivalLead{9, 4.6}.leads()));
  EXPECT_FALSE((stats::RivalLead{0.8, 0.1}.leads())) << "a nested model's small loss is no lead";
  EXPECT_FALSE((stats::RivalLead{-9, 1}.leads()));
}

TEST(RivalComparison, WeightsAreThoseOfLoo) {
  const auto made = rival_oracle::all();
  for (const auto& item : made.at("stacking")) {
    std::vector<std::vector<double>> scores;
    for (const auto& column : item.at("scores")) scores.push_back(doubles(column));
    const auto weights = stats::stacking_weights(scores), want = doubles(item.at("weights"));
    double sum = 0;
    for (std::size_t k = 0; k < want.size(); ++k) {
      EXPECT_NEAR(weights[k], want[k], 2e-3);
      sum += weights[k];
    }
    EXPECT_NEAR(sum, 1, 1e-9);
  }
  EXPECT_THROW(stats::stacking_weights({}), std::invalid_argument);
  EXPECT_THROW(stats::stacking_weights({{-1, -HUGE_VAL}}), std::invalid_argument);
}

TEST(RivalComparison, ImitationIsThatOfLm) {
  const auto item = rival_oracle::all().at("imitation");
  const auto y = doubles(item.at("target")), x1 = doubles(item.at("x1")), x2 = doubles(item.at("x2"));
  EXPECT_NEAR(stats::imitated_share(y, {x1}), item.at("one").get<double>(), 1e-9);
  EXPECT_NEAR(stats::imitated_share(y, {x1, x2}), item.at("two").get<double>(), 1e-4);
  EXPECT_DOUBLE_EQ(stats::imitated_share(std::vector<double>(y.size(), 2.0), {x1}), 0);
  EXPECT_THROW(stats::imitated_share(y, {}), std::invalid_argument);
}

TEST(RivalComparison, FoldsAreDealtBySeed) {
  const Study study;
  const auto total = [&](int folds, std::uint64_t seed) {
    stats::RivalComparisonOptions options;
    options.folds = folds;
    options.seed = seed;
    return stats::compare_rivals(study.models, study.data.answers, -1, options)->models[1].total;
  };
  EXPECT_EQ(total(4, 1), total(4, 1));
  EXPECT_NE(total(4, 1), total(4, 2));
  EXPECT_NEAR(total(8, 3), total(0, 1), 1e-9) << "as many groups as people leave each person out alone";
  stats::RivalComparisonOptions wrong;
  wrong.folds = 9;
  EXPECT_THROW(stats::compare_rivals(study.models, study.data.answers, -1, wrong), std::invalid_argument);
}

TEST(RivalComparison, PartsOfTheGroupsGiveTheWholeBitForBit) {
  const Study study;
  stats::RivalComparisonOptions options;
  options.folds = 5;
  ASSERT_EQ(stats::rival_group_count(study.data.answers.people, options), 5);
  std::vector<std::vector<stats::Result<stats::RivalFit>>> without;
  for (const auto& model : study.models) {
    auto& fits = without.emplace_back();
    for (const stats::RivalGroups part : {stats::RivalGroups{0, 2}, {2, 3}})
      for (const auto& fit : stats::fit_without_groups(model, study.data.answers, options, part))
        fits.push_back(fit);
  }
  const auto serial = stats::compare_rivals(study.models, study.data.answers, -1, options);
  const auto joined = stats::compare_rivals(study.models, study.data.answers, -1, options, &without);
  ASSERT_TRUE(serial && joined);
  EXPECT_EQ(joined->order, serial->order);
  for (std::size_t m = 0; m < study.models.size(); ++m) {
    EXPECT_EQ(joined->models[m].by_person, serial->models[m].by_person);
    EXPECT_EQ(joined->models[m].probabilities, serial->models[m].probabilities);
    EXPECT_EQ(joined->models[m].weight, serial->models[m].weight);
  }
  without[1].pop_back();
  EXPECT_THROW(stats::compare_rivals(study.models, study.data.answers, -1, options, &without),
               std::invalid_argument);
  without.pop_back();
  EXPECT_THROW(stats::compare_rivals(study.models, study.data.answers, -1, options, &without),
               std::invalid_argument);
}

TEST(RivalComparison, TwinsCannotBeToldApart) {
  Study study;
  study.models[1] = study.models[0];
  study.models[1].name = "twin";
  const auto result = stats::compare_rivals(study.models, study.data.answers, -1, {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->verdict, RivalVerdict::Undecided);
  EXPECT_EQ(result->in_the_running.size(), 2u);
}

TEST(RivalComparison, RefusesFewPeopleAndOneModel) {
  const Study study;
  auto few = study.data.answers;
  for (int& p : few.person) p %= 7;
  few.people = 7;
  EXPECT_EQ(stats::compare_rivals(study.models, few, -1, {}).reason(),
            "models are compared over at least 8 people, not 7");
  EXPECT_EQ(stats::compare_rivals({study.models[0]}, study.data.answers, -1, {}).reason(),
            "fewer than two models can be fitted");
}

}  // namespace
