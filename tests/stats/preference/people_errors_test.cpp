/// Standard errors over people of the preference models, against R (tests/stats/r/bradley_terry_people.R),
/// and their coverage.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <vector>

#include "stats/base/json.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/preference/order_bias.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using stats::Comparison;

/// glm stops at a relative change of the deviance of 1e-14, which leaves this error in a coefficient.
constexpr double glm_error = 1e-9;

std::vector<Comparison> trials_of(const json& item) {
  std::vector<Comparison> out;
  for (const auto& t : item.at("trials")) out.push_back({t[1], t[2], t[3] == 1, t[4], t[0]});
  return out;
}

void expect_near(double got, const json& want, const std::string& what) {
  EXPECT_NEAR(got, want.get<double>(), glm_error * (1 + std::abs(want.get<double>()))) << what;
}

void expect_term(const stats::OrderTerm& got, const json& want, const std::string& what) {
  expect_near(got.estimate, want.at("estimate"), what);
  expect_near(got.se, want.at("se"), what + " se");
  expect_near(got.se_independent, want.at("se_independent"), what + " se_independent");
  expect_near(got.p_wald, want.at("p"), what + " p");
}

TEST(PeopleErrors, AreThoseOfTheSandwichInR) {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/bradley_terry_people.json");
  const json made = json::parse(in);
  int pairs = 0;
  for (const auto& item : made.at("cases")) {
    const auto trials = trials_of(item);
    const int items = item.at("items");
    const auto model = stats::bradley_terry(trials, items);
    ASSERT_TRUE(model) << model.reason();
    EXPECT_EQ(*model->people_df, item.at("df").get<double>());
    for (std::size_t i = 0; i < model->se_sum0.size(); ++i) {
      expect_near(model->se_sum0[i], item.at("se_sum0")[i], "se_sum0");
      expect_near(model->se_sum0_independent[i], item.at("se_sum0_independent")[i], "independent");
    }
    for (std::size_t i = 0; i < model->pairs.size(); ++i, ++pairs) {
      const auto& pair = model->pairs[i];
      expect_near(pair.difference, item.at("difference")[i], "difference");
      expect_near(pair.se, item.at("difference_se")[i], "difference_se");
      expect_near(pair.p, item.at("difference_p")[i], "difference_p");
      expect_near(pair.ci[1] - pair.difference, item.at("half_width")[i], "half_width");
    }
    ASSERT_TRUE(model->equal_over_people);
    expect_near(model->equal_over_people->f, item.at("f"), "f");
    expect_near(model->equal_over_people->p, item.at("f_p"), "f_p");
    const auto order = stats::order_bias(trials, items);
    ASSERT_TRUE(order && order->drift);
    expect_term(order->interval, item.at("interval"), "interval");
    expect_term(*order->drift, item.at("drift"), "drift");
  }
  EXPECT_EQ(pairs, 29);
}

/// Everyone judges all pairs of three items in three scenes. A person's strengths are normal about (0, 0, 0)
/// with the SD `taste`.
std::vector<Comparison> people_with_tastes(int people, double taste, uniformity::Draws& draws) {
  std::vector<Comparison> out;
  for (int person = 0; person < people; ++person) {
    // Sums of twelve uniforms are close enough to normal.
    double own[3] = {};
    for (double& one : own) {
      for (int i = 0; i < 12; ++i) one += draws.uniform();
      one = taste * (one - 6);
    }
    for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
      for (int scene = 0; scene < 3; ++scene)
        out.push_back({a, b, draws.coin(1 / (1 + std::exp(own[b] - own[a]))), 1, person});
  }
  return out;
}

// Shares of 1,000 studies in which 95 % intervals cover the truth; three standard errors of a share are 2.1
// %.
TEST(PeopleErrors, CoverWhatTheySayWherePeopleHaveTastes) {
  uniformity::Draws draws(5);
  int covered = 0, independent = 0;
  constexpr int studies = 1000;
  for (int study = 0; study < studies; ++study) {
    const auto model = stats::bradley_terry(people_with_tastes(20, 1.5, draws), 3);
    ASSERT_TRUE(model) << model.reason();
    const auto& pair = model->pairs[0];  // equal in the population
    covered += pair.ci[0] <= 0 && 0 <= pair.ci[1];
    independent += std::abs(pair.difference) <= 1.96 * pair.se_independent;
  }
  EXPECT_NEAR(1.0 * covered / studies, 0.95, 0.021);
  EXPECT_LT(1.0 * independent / studies, 0.85) << "answers of one person are not independent";
}

TEST(PeopleErrors, StepBackWithAReasonWherePeopleDoNotBearThem) {
  uniformity::Draws draws(6);
  const auto few = stats::bradley_terry(people_with_tastes(2, 0.5, draws), 3);
  ASSERT_TRUE(few);
  EXPECT_FALSE(few->people_df);
  if (!few->bias_reduced) {
    EXPECT_EQ(few->why_independent, "2 people are too few for errors over people of 2 coefficients");
  }
  // Everyone has the same cycle: people do not differ, so the sandwich errors would be zero.
  std::vector<Comparison> circle;
  for (int person = 0; person < 8; ++person)
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}}) circle.push_back({a, b, true, 1, person});
  const auto alike = stats::bradley_terry(circle, 3);
  ASSERT_TRUE(alike) << alike.reason();
  EXPECT_NE(alike->why_independent.find("alike"), std::string::npos) << alike->why_independent;
  EXPECT_GT(alike->pairs[0].se, 0.3);
  EXPECT_EQ(alike->pairs[0].se, alike->pairs[0].se_independent);
  // With an item that always wins, Firth's estimate has standard errors that take answers as independent.
  std::vector<Comparison> always;
  for (int person = 0; person < 8; ++person)
    for (const auto& [a, b, won] : {std::tuple{0, 1, true}, {0, 2, true}, {1, 2, person % 2 == 0}})
      always.push_back({a, b, won, 1, person});
  const auto penalised = stats::bradley_terry(always, 3);
  ASSERT_TRUE(penalised) << penalised.reason();
  EXPECT_TRUE(penalised->bias_reduced);
  EXPECT_EQ(penalised->why_independent, "the strengths are penalised");
}

}  // namespace
