/// Rival models: the likelihood with lapses, and fits against R (tests/stats/r/rival_models.R).

#include "stats/ordinal/rival_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "stats/ordinal/mixed_likelihood.hpp"
#include "tests/stats/ordinal/rival_oracle.hpp"

namespace {

using rival_oracle::data_of;
using stats::Link;
using stats::RivalAnswers;
using stats::RivalFitter;
using stats::RivalModel;
using stats::RivalOptions;

/// Options of a plain mixed model, as clmm and glmer fit it.
RivalOptions plain() {
  RivalOptions out;
  out.points = 15;
  out.prior_sd = std::numeric_limits<double>::infinity();
  out.lapse = 0;
  return out;
}

/// Twelve answers of two people, one of them an outlier that only a lapse explains.
struct Lapsing {
  std::vector<int> category{0, 1, 2, 3, 3, 0, 1, 1, 2, 2, 3, 3}, person{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  std::vector<double> thresholds{-1, 0.3, 1.4}, location;
  double sd = 0.8;

  Lapsing() {
    for (int i = 0; i < 12; ++i) location.push_back(0.6 * (i % 6) - 1);
    location[5] = 5;
  }
  double likelihood(int points, double lapse, stats::MixedGradient& gradient) const {
    return stats::MixedLikelihood(category, person, Link::Probit, points)
        .evaluate(thresholds, location, sd, gradient, {lapse, 7});
  }
  double likelihood(int points, double lapse) const {
    stats::MixedGradient ignored;
    return likelihood(points, lapse, ignored);
  }
  /// The sum over 4,001 points of each person's effect.
  double by_brute_force(double lapse) const {
    double out = 0;
    for (int p = 0; p < 2; ++p) {
      double sum = 0;
      for (int k = -2000; k <= 2000; ++k) {
        const double u = k * 0.005;
        double product = std::exp(-u * u / 2) / std::sqrt(2 * std::numbers::pi) * 0.005;
        for (std::size_t i = 0; i < 12; ++i) {
          if (person[i] != p) continue;
          const auto c = static_cast<std::size_t>(category[i]);
          const double v = location[i] + sd * u;
          const double up = c < 3 ? stats::link_value(Link::Probit, thresholds[c] - v).F : 1;
          const double low = c > 0 ? stats::link_value(Link::Probit, thresholds[c - 1] - v).F : 0;
          product *= (1 - lapse) * (up - low) + lapse / 7;
        }
        sum += product;
      }
      out += std::log(sum);
    }
    return out;
  }
};

TEST(Lapses, LikelihoodIsTheIntegralOverPeople) {
  const Lapsing data;
  for (const double lapse : {0.0, 0.02, 0.3})
    EXPECT_NEAR(data.likelihood(61, lapse), data.by_brute_force(lapse), 1e-8) << lapse;
}

TEST(Lapses, GradientIsThatOfTheLikelihood) {
  for (const int points : {1, 5}) {
    for (const double lapse : {0.02, 0.3}) {
      Lapsing data;
      stats::MixedGradient gradient, ignored;
      data.likelihood(points, lapse, gradient);
      const double h = 1e-5, tiny = 1e-6;
      const auto slope = [&](double& at) {
        const double here = at;
        at = here + h;
        const double above = data.likelihood(points, lapse);
        at = here - h;
        const double below = data.likelihood(points, lapse);
        at = here;
        return (above - below) / (2 * h);
      };
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(gradient.thresholds[j], slope(data.thresholds[j]), 1e-7) << points << ' ' << lapse;
      for (std::size_t i = 0; i < 12; ++i)
        EXPECT_NEAR(gradient.location[i], slope(data.location[i]), 1e-7) << points << ' ' << lapse;
      EXPECT_NEAR(gradient.sd, slope(data.sd), 1e-7);
      EXPECT_NEAR(
          gradient.lapse,
          (data.likelihood(points, lapse + tiny) - data.likelihood(points, lapse - tiny)) / (2 * tiny), 1e-6);
    }
  }
}

TEST(RivalFit, AgreesWithClmm) {
  int sets = 0;
  const auto made = rival_oracle::all();
  for (const auto& item : made.at("clmm")) {
    const auto data = data_of(item.at("data"));
    const auto fit = RivalFitter(data.model({0}), data.answers, plain()).fit();
    ASSERT_TRUE(fit) << data.name << ": " << fit.reason();
    EXPECT_NEAR(fit->log_likelihood, item.at("log_likelihood").get<double>(), 2e-6) << data.name;
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_NEAR(fit->coefficients[j], item.at("coefficients")[j].get<double>(), 1e-3) << data.name;
    for (std::size_t j = 0; j < fit->thresholds.size(); ++j)
      EXPECT_NEAR(fit->thresholds[j], item.at("thresholds")[j].get<double>(), 2e-3) << data.name;
    EXPECT_NEAR(fit->sd_person, item.at("sd").get<double>(), 2e-3) << data.name;
    ++sets;
  }
  EXPECT_EQ(sets, 10);
}

TEST(RivalFit, OfTwoScoresAgreesWithLme4) {
  const auto made = rival_oracle::all();
  for (const auto& item : made.at("lme4")) {
    const auto data = data_of(item.at("data"));
    const auto fit = RivalFitter(data.model({0}), data.answers, plain()).fit();
    ASSERT_TRUE(fit) << fit.reason();
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_NEAR(fit->coefficients[j], item.at("coefficients")[j].get<double>(), 1e-3) << data.name;
    EXPECT_NEAR(fit->thresholds[0], item.at("threshold").get<double>(), 1e-3) << data.name;
    EXPECT_NEAR(fit->sd_person, item.at("sd").get<double>(), 1e-3) << data.name;
  }
}

TEST(RivalFit, WithLapsesAgreesWithBruteForce) {
  const auto made = rival_oracle::all();
  for (const auto& item : made.at("lapses")) {
    const auto data = data_of(item.at("data"));
    auto answers = data.answers;
    answers.choices = item.at("choices");
    RivalOptions options;
    options.points = 25;
    std::vector<std::size_t> columns(data.x.size());
    std::iota(columns.begin(), columns.end(), 0u);
    const auto fit = RivalFitter(data.model(columns), answers, options).fit();
    ASSERT_TRUE(fit) << fit.reason();
    EXPECT_NEAR(fit->log_likelihood, item.at("log_likelihood").get<double>(), 1e-4) << data.name;
    for (std::size_t j = 0; j < fit->coefficients.size(); ++j)
      EXPECT_NEAR(fit->coefficients[j], item.at("coefficients")[j].get<double>(), 2e-3) << data.name;
    EXPECT_NEAR(fit->sd_person, item.at("sd").get<double>(), 2e-3) << data.name;
    EXPECT_NEAR(fit->lapse, item.at("lapse").get<double>(), 1e-3) << data.name;
  }
}

TEST(RivalFit, FiveNodesAreEnoughForAPilot) {
  const auto item = rival_oracle::all().at("lapses")[0];
  const auto data = data_of(item.at("data"));
  RivalOptions options;
  const auto five = RivalFitter(data.model({0}), data.answers, options).fit();
  EXPECT_NEAR(five->log_likelihood, item.at("log_likelihood").get<double>(), 0.01);
}

TEST(RivalFit, PredictsANewPersonAndScoresAPerson) {
  const auto data = data_of(rival_oracle::all().at("lapses")[1].at("data"));
  RivalFitter fitter(data.model({0, 1}), data.answers, {});
  const auto fit = fitter.fit();
  ASSERT_TRUE(fit);
  double sum = 0;
  for (const double p : fitter.probabilities(*fit, std::size_t{3})) sum += p;
  EXPECT_NEAR(sum, 1, 1e-12);
  // The predictions of all rows are those of the likelihood with one answer.
  for (std::size_t row = 0; row < 12; ++row) {
    RivalAnswers one{{data.answers.score[row]}, {0}, data.answers.choices, 1};
    const auto c = static_cast<std::size_t>(data.answers.score[row]);
    auto some = data.answers;
    some.person.assign(some.n(), 1);
    some.person[row] = 0;
    some.people = 2;
    const double score = RivalFitter(data.model({0, 1}), some, {}).log_score(*fit, 0);
    EXPECT_NEAR(score, std::log(fitter.probabilities(*fit, row)[c]), 1e-8);
  }
  // b of x_1 - b x_2 is 0.05 in the study; eight people tell it roughly.
  EXPECT_NEAR(fitter.ratios(*fit)[0], 0.05, 0.03);
}

TEST(RivalFit, AScoreThatNobodyGaveIsAGuess) {
  auto data = data_of(rival_oracle::all().at("lapses")[0].at("data"));
  for (std::size_t i = 0; i < data.answers.n(); ++i)
    if (data.answers.person[i] != 0 && data.answers.score[i] == 6) data.answers.score[i] = 5;
  RivalFitter fitter(data.model({0}), data.answers, {});
  ASSERT_TRUE(fitter.fit());
  std::vector<char> in(static_cast<std::size_t>(data.answers.people), 1);
  in[0] = 0;
  const auto fit = fitter.fit_some(in);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_EQ(fit->scores.back(), 5);
  EXPECT_TRUE(std::isfinite(fitter.log_score(*fit, 0)));
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(fitter.probabilities(*fit, i)[6], fit->lapse / 7, 1e-12);
}

TEST(RivalFit, RefusesByName) {
  auto data = data_of(rival_oracle::all().at("lapses")[1].at("data"));
  auto same = data;
  same.x[0].assign(same.x[0].size(), 3.4);
  EXPECT_EQ(RivalFitter(same.model({0}), same.answers, {}).fit().reason(), "x0 is the same in all trials");
  auto equal = data.answers;
  equal.score.assign(equal.n(), 2);
  EXPECT_EQ(RivalFitter(data.model({0}), equal, {}).fit().reason(), "all answers are equal");
  auto alone = data.answers;
  alone.person.assign(alone.n(), 0);
  EXPECT_EQ(RivalFitter(data.model({0}), alone, {}).fit().reason(), "there are fewer than two people");
  auto nan = data.model({0});
  nan.predictors[0].values[4] = std::nan("");
  EXPECT_THROW(RivalFitter(nan, data.answers, {}), std::invalid_argument);
  RivalOptions wrong;
  wrong.lapse = 0.7;
  EXPECT_THROW(RivalFitter(data.model({0}), data.answers, wrong), std::invalid_argument);
}

TEST(RivalFit, SeparatedAnswersKeepFiniteCoefficients) {
  RivalAnswers answers{{}, {}, 3, 8};
  RivalModel model{"split", {{"x", {}}}, false};
  for (int p = 0; p < 8; ++p) {
    for (int s = 0; s < 3; ++s) {
      answers.score.push_back(s);
      answers.person.push_back(p);
      model.predictors[0].values.push_back(s);
    }
  }
  const auto fit = RivalFitter(model, answers, {}).fit();
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_GT(fit->coefficients[0], 1);
  EXPECT_LT(fit->coefficients[0], 30);
}

}  // namespace
