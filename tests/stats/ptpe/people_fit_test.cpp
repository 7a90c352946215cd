/// Each person's own contour with partial pooling, against R (tests/stats/r/people_contours.R) and
/// simulation.

#include "stats/ptpe/people_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/base/json.hpp"
#include "stats/ptpe/people_likelihood.hpp"

namespace {

using stats::fit_people;
using stats::PeopleOptions;
using stats::PilotMean;
using stats::PilotRating;

PilotRating rating(int person, double mu, double delta, double score, int position = -1) {
  return {person, mu, delta, mu, mu, delta, score, position};
}

base::Json r_cases() {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/people_contours.json");
  return base::Json::parse(in).at("cases");
}

std::vector<PilotRating> ratings_of(const base::Json& one) {
  std::vector<PilotRating> out;
  for (std::size_t i = 0; i < one.at("score").size(); ++i)
    out.push_back(
        rating(one["person"][i], one["mu"][i], one["delta"][i], one["score"][i], one["position"][i]));
  return out;
}

void expect_near(const base::Json& one, const stats::PeopleFit& fit, double share, double log_likelihood) {
  const std::string name = one.at("name");
  const auto real = [&](const char* key) { return one.at(key).get<double>(); };
  // `share` of a standard error, or of the spread over people.
  const double se_a = std::sqrt(fit.population.var_log_a), se_b = std::sqrt(fit.population.var_b);
  EXPECT_NEAR(fit.population.curve.log_a, std::log(real("a")), share * se_a) << name;
  EXPECT_NEAR(fit.population.curve.b, real("b"), share * se_b) << name;
  EXPECT_NEAR(fit.sd_log_a.value, real("sd_log_a"), share * se_a) << name;
  EXPECT_NEAR(fit.sd_b.value, real("sd_b"), share * se_b) << name;
  EXPECT_NEAR(fit.correlation.value, real("correlation"), share) << name;
  EXPECT_NEAR(fit.k, real("k"), share) << name;
  EXPECT_NEAR(fit.m, real("m"), 0.1 * share) << name;
  EXPECT_NEAR(fit.q, real("q"), share) << name;
  EXPECT_NEAR(fit.drift ? fit.drift->value : 0, real("drift"), share) << name;
  EXPECT_NEAR(fit.lapse, real("lapse"), 0.1 * share) << name;
  EXPECT_NEAR(fit.log_likelihood, real("log_likelihood"), log_likelihood) << name;
  ASSERT_EQ(fit.people.size(), one.at("own_b").size()) << name;
  for (std::size_t p = 0; p < fit.people.size(); ++p) {
    const auto& own = fit.people[p].pooled;
    EXPECT_NEAR(own.curve.log_a, one["own_log_a"][p].get<double>(), share * std::sqrt(own.var_log_a)) << name;
    EXPECT_NEAR(own.curve.b, one["own_b"][p].get<double>(), share * std::sqrt(own.var_b)) << name;
  }
}

/// clmm approximates the integrals by Laplace's method and gives the modes of people's effects.
void expect_clmm(const base::Json& one) {
  PeopleOptions options;
  options.straight = true;
  options.drift = options.hold_spread = false;
  options.lapse = 0;
  const auto fit = fit_people(ratings_of(one), PilotMean::Harmonic, one.at("level"), options);
  ASSERT_TRUE(fit) << fit.reason();
  expect_near(one, *fit, 0.03, 0.02);
}

void expect_whole(const base::Json& one) {
  PeopleOptions options;
  options.points = 7;
  const auto fit = fit_people(ratings_of(one), PilotMean::Harmonic, one.at("level"), options);
  ASSERT_TRUE(fit) << fit.reason();
  expect_near(one, *fit, 0.01, 3e-3);
}

TEST(PeopleFit, AgreesWithClmm) { expect_clmm(r_cases().at(0)); }
TEST(PeopleFitSlow, AgreesWithClmm) {
  expect_clmm(r_cases().at(1));
  expect_clmm(r_cases().at(2));
}
TEST(PeopleFit, AgreesWithTheModelWrittenOutInR) { expect_whole(r_cases().at(3)); }
TEST(PeopleFitSlow, AgreesWithTheModelWrittenOutInR) { expect_whole(r_cases().at(4)); }

/// Ratings of the paper's 21 settings by one rule; `first`: number of the first person.
std::vector<PilotRating> judged(int people, const std::function<double(int, double, double)>& score,
                                int first = 0) {
  std::vector<PilotRating> out;
  for (int p = first; p < first + people; ++p)
    for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0})
      for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0})
        if (delta < mu) out.push_back(rating(p, mu, delta, score(p, mu, delta)));
  return out;
}

/// Scores of people whose a lies from 20 to 26, with errors that look random and are not.
double usual(int person, double mu, double delta) {
  const double tau = mu - (20 + person % 7) * std::exp(0.02 * delta);
  const double error = std::sin(100 * std::sin(31.0 * person + 7 * mu + 3 * delta)) * 1.4;
  return std::clamp(std::round(4 + 0.14 * tau + error), 1.0, 7.0);
}

/// The sum over a grid of both effects, and the slopes by differences.
TEST(PeopleLikelihood, IsTheIntegralAndHasItsGradient) {
  stats::PeopleRows rows;
  rows.levels = {1, 3, 4, 7};
  rows.people = 2;
  for (int i = 0; i < 14; ++i) {
    rows.x.push_back(0.3 * (i % 5) - 0.6);
    rows.d.push_back(0.5 * (i % 3) - 0.5);
    rows.position.push_back(i / 13.0 - 0.5);
    rows.person.push_back(i % 2);
    rows.category.push_back(std::min(3, (i % 5) * 4 / 5 + (i == 10)));
  }
  const std::vector<double> at{-0.2, 0.3,  0.1,           0.2,           2.5, 0.3,
                               0.6,  -0.4, std::log(0.4), std::log(0.3), 0.5, 0.4};
  stats::PeopleLikelihood likelihood(rows, 3.5, 0.005, 15);
  std::vector<double> gradient(at.size()), ignored(at.size());
  const double value = likelihood.evaluate(at, gradient);
  double by_grid = 0;
  for (int p = 0; p < 2; ++p) {
    double sum = 0;
    for (double u = -6; u <= 6; u += 0.2) {
      for (double w = -6; w <= 6; w += 0.2) {
        const double rho = std::tanh(0.5);
        std::array<double, 2> slope{};
        const std::array<double, 2> own{0.1 + 0.4 * u, 0.2 + 0.3 * (rho * u + std::sqrt(1 - rho * rho) * w)};
        sum += std::exp(likelihood.of_person(p, at, own, slope) - (u * u + w * w) / 2) * 0.04;
      }
    }
    by_grid += std::log(sum / (2 * std::numbers::pi));
  }
  EXPECT_NEAR(value, by_grid, 1e-6);
  likelihood.follow(false);
  for (std::size_t i = 0; i < at.size(); ++i) {
    auto moved = at;
    moved[i] += 1e-5;
    const double above = likelihood.evaluate(moved, ignored);
    moved[i] -= 2e-5;
    EXPECT_NEAR(gradient[i], (above - likelihood.evaluate(moved, ignored)) / 2e-5, 1e-5) << i;
  }
}

TEST(PeopleFit, APersonLeansOnTheOthersTheMoreTheLessTheAnswersSay) {
  auto ratings = judged(6, usual);
  const auto few = judged(1, usual, 6);
  ratings.insert(ratings.end(), {few[5], few[8], few[12]});
  const auto fit = fit_people(ratings, PilotMean::Harmonic, 4);
  ASSERT_TRUE(fit) << fit.reason();
  ASSERT_EQ(fit->people.size(), 7u);
  const auto& three = fit->people[6];
  EXPECT_EQ(three.answers, 3);
  EXPECT_LT(three.own_share, 0.5);
  EXPECT_NE(three.doubt(), "");
  double pooled_spread = 0, alone_spread = 0;
  for (int p = 0; p < 6; ++p) {
    const auto& one = fit->people[static_cast<std::size_t>(p)];
    EXPECT_EQ(one.doubt(), "") << p;
    EXPECT_GT(one.own_share, three.own_share);
    EXPECT_LT(one.pooled.var_log_a, three.pooled.var_log_a);
    ASSERT_TRUE(one.alone);
    EXPECT_EQ(one.in_reach.size(), 5u);
    pooled_spread += std::abs(one.pooled.curve.log_a - fit->population.curve.log_a);
    alone_spread += std::abs(one.alone->curve.log_a - fit->population.curve.log_a);
    const auto band = one.band(0, 0.95);
    EXPECT_NEAR(band[0], one.a_ci[0], 1e-9);
    EXPECT_NEAR(band[1], one.a_ci[1], 1e-9);
  }
  EXPECT_LT(pooled_spread, 0.8 * alone_spread);
  EXPECT_GT(pooled_spread, 0.2 * alone_spread);
  EXPECT_FALSE(fit->drift);  // no trial has a position
}

TEST(PeopleFit, APersonWithOneAnswerHasNoContour) {
  auto ratings = judged(6, usual);
  const auto same = judged(
      1, [](int, double, double) { return 7; }, 6);
  ratings.insert(ratings.end(), same.begin(), same.end());
  const auto fit = fit_people(ratings, PilotMean::Harmonic, 4);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_EQ(fit->people[6].doubt(), "all answers are equal");
  EXPECT_FALSE(fit->people[6].alone);
}

TEST(PeopleFit, RefusesWhatDoesNotDetermineIt) {
  const auto reason = [](const std::vector<PilotRating>& ratings, double level = 4) {
    const auto fit = fit_people(ratings, PilotMean::Harmonic, level);
    return fit ? std::string() : fit.reason();
  };
  EXPECT_EQ(reason({}), "no ratings");
  EXPECT_NE(reason(judged(4, usual)).find("and 4 people have answers"), std::string::npos);
  auto one = judged(1, usual);
  for (int k = 0; k < 5; ++k) {
    const auto more = judged(1, usual);
    one.insert(one.end(), more.begin(), more.end());
  }
  EXPECT_NE(reason(one).find("1 person has answers to three settings: repeated trials of one person are no"),
            std::string::npos);
  std::vector<PilotRating> level_rate;
  for (const auto& r : judged(6, usual))
    if (r.delta == 5) level_rate.push_back(r);
  EXPECT_NE(reason(level_rate).find("need 6 settings"), std::string::npos);
  EXPECT_EQ(reason(judged(6, [](int, double, double) { return 4; })),
            "all ratings are equal: there is no threshold to estimate");
  EXPECT_NE(reason(judged(6, usual), 8).find("level does not lie between"), std::string::npos);
  EXPECT_NE(reason(judged(6, [](int p, double mu, double delta) { return 8 - usual(p, mu, delta); })), "");
  PeopleOptions options;
  options.points = 1;
  EXPECT_THROW(fit_people(one, PilotMean::Harmonic, 4, options), std::invalid_argument);
}

}  // namespace
