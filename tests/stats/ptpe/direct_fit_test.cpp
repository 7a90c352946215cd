#include "stats/ptpe/direct_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/stats/ptpe/simulated_ratings.hpp"

namespace {

using stats::PilotObservation;

/// Scores of the fit `truth`, with an effect of each participant and noise.
std::vector<PilotObservation> surface(const stats::DirectFit& truth, int participants, double person_sd,
                                      double noise, std::uint64_t seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<PilotObservation> out;
  for (int p = 0; p < participants; ++p) {
    const double person = person_sd * normal(engine);
    for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0}) {
      for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0}) {
        if (delta >= mu) continue;
        const double score = truth.score(mu, delta) + person + noise * normal(engine);
        out.push_back({p, mu, delta, score, delta});
      }
    }
  }
  return out;
}

stats::DirectFit model(double a, double b, double k, double m, double q) {
  stats::DirectFit fit;
  fit.curve = {std::log(a), b};
  fit.k = k;
  fit.m = m;
  fit.q = q;
  return fit;
}

TEST(DirectFit, ReturnsTheSurfaceThatItIsGiven) {
  for (const auto& truth : {model(24, 0.02, 3, 0.04, 0.4), model(31, 0.01, 2, 0, -0.7),
                            model(20, 0.035, 4, -0.05, 0), model(28, 0, 1.5, 0.1, 0.9)}) {
    const auto fit = stats::DirectModel(surface(truth, 2, 0, 0), 4).fit();
    ASSERT_TRUE(fit) << fit.reason();
    EXPECT_NEAR(fit->curve.a(), truth.curve.a(), 1e-6);
    EXPECT_NEAR(fit->curve.b, truth.curve.b, 1e-8);
    EXPECT_NEAR(fit->k, truth.k, 1e-5);
    EXPECT_NEAR(fit->m, truth.m, 1e-6);
    EXPECT_NEAR(fit->q, truth.q, 1e-5);
    EXPECT_NEAR(fit->rss, 0, 1e-9);
  }
}

TEST(DirectFit, TheReasonOfNoFitIsTheTrueOne) {
  auto data = surface(model(24, 0.02, 3, 0.04, 0.4), 4, 0, 0);
  const auto reasons = [&](double level) {
    const stats::DirectModel fitted(data, level);
    return std::pair(fitted.fit().reason(), fitted.fit_straight().reason());
  };
  const std::string beyond =
      "no contour: the model's curve does not meet the level within the settings shown";
  EXPECT_EQ(reasons(1000), std::pair(beyond, beyond));
  for (auto& o : data) o.score = o.delta / 5;
  EXPECT_EQ(reasons(2).second, "the scores do not depend on the mean frame rate");
  for (const double level : {4.0, 5.0}) {
    for (auto& o : data) o.score = 5;
    EXPECT_EQ(reasons(level),
              std::pair(std::string("all ratings are equal"), std::string("all ratings are equal")));
  }
  for (auto& o : data) o = {o.participant, 20, 5, o.mu, 5};
  EXPECT_EQ(reasons(4),
            std::pair(std::string("the settings rated do not determine a surface over mean and deviation"),
                      std::string("the settings rated do not determine a plane over mean and deviation")));
}

TEST(DirectFit, NoOtherSurfaceNearbyHasASmallerSum) {
  const auto data = surface(model(24, 0.02, 3, 0.04, 0.4), 6, 0.5, 1);
  const auto fit = *stats::DirectModel(data, 4).fit();
  const auto rss = [&](const stats::DirectFit& f) {
    double sum = 0;
    for (const auto& o : data) sum += std::pow(o.score - f.score(o.mu, o.delta), 2);
    return sum;
  };
  EXPECT_NEAR(rss(fit), fit.rss, 1e-8 * fit.rss);
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    auto other = fit;
    const double reach = std::pow(10, -i % 5);
    other.curve.log_a += 0.3 * reach * normal(engine);
    other.curve.b += 0.02 * reach * normal(engine);
    other.k += reach * normal(engine);
    other.m += 0.05 * reach * normal(engine);
    other.q += reach * normal(engine);
    EXPECT_GE(rss(other), fit.rss * (1 - 1e-12));
  }
}

TEST(DirectFit, OrderOfRowsAndUnitsOfTheFrameRateFollowThrough) {
  auto data = surface(model(24, 0.02, 3, 0.04, 0.4), 6, 0.5, 1);
  const auto one = stats::estimate_direct(data, 4, {0, 1, 0.95});
  std::shuffle(data.begin(), data.end(), std::mt19937_64(1));
  for (auto& o : data) {
    o.mu *= 2;
    o.delta *= 2;
    o.nominal_delta *= 2;
    o.score += 1;
    o.participant = 5 - o.participant;
  }
  const auto two = stats::estimate_direct(data, 5, {0, 1, 0.95});
  ASSERT_TRUE(one.jackknife && two.jackknife);
  for (const int end : {0, 1}) {
    EXPECT_NEAR(two.jackknife->a_ci[end], 2 * one.jackknife->a_ci[end], 1e-6);
    EXPECT_NEAR(two.jackknife->b_ci[end], one.jackknife->b_ci[end] / 2, 1e-9);
  }
  EXPECT_NEAR(two.lack_of_fit->p, one.lack_of_fit->p, 1e-7);
}

TEST(DirectFit, ChoosesTheLineOnWhichScoresRise) {
  // The scores are 4 + u (k + q u), with u = log mu - log mu(delta). They are 4 also at u = -k / q, but fall
  // there.
  const auto truth = model(30, 0.01, 1, 0, 1.2);
  const auto fit = stats::DirectModel(surface(truth, 2, 0, 0), 4).fit();
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->curve.a(), 30, 1e-6);
  EXPECT_GT(fit->k, 0);
}

TEST(DirectFit, RefusesWhatHasNoCurve) {
  const auto refusal = [](std::vector<PilotObservation> data) {
    const auto estimate = stats::estimate_direct(data, 4, {100, 1, 0.95});
    EXPECT_FALSE(estimate.fit);
    EXPECT_FALSE(estimate.jackknife);
    EXPECT_FALSE(estimate.bootstrap);
    EXPECT_FALSE(estimate.lack_of_fit);
    EXPECT_FALSE(estimate.lack_of_fit.reason().empty());
    return estimate.fit.reason();
  };
  EXPECT_EQ(refusal({}), "no ratings");
  auto data = surface(model(24, 0.02, 3, 0.04, 0), 5, 0.5, 1);
  auto satisfied = data, equal = data, upside_down = data, two_columns = data;
  for (auto& o : satisfied) o.score += 20;
  EXPECT_NE(refusal(satisfied).find("no contour"), std::string::npos);
  for (auto& o : equal) o.score = 4;
  EXPECT_FALSE(refusal(equal).empty());
  for (auto& o : upside_down) o.score = 8 - o.score;
  EXPECT_NE(refusal(upside_down).find("rise"), std::string::npos) << refusal(upside_down);
  std::erase_if(two_columns, [](const auto& o) { return o.delta > 5; });
  EXPECT_NE(refusal(two_columns).find("do not determine"), std::string::npos);
  EXPECT_NE(refusal({data[0]}).find("do not determine"), std::string::npos);
  data[0].mu = 0;
  EXPECT_THROW(stats::DirectModel(data, 4), std::invalid_argument);
}

TEST(DirectFit, RefusesAnIntervalOverTooFewParticipants) {
  const auto estimate = stats::estimate_direct(surface(model(24, 0.02, 3, 0, 0), 3, 0.5, 1), 4, {});
  EXPECT_TRUE(estimate.fit);
  EXPECT_FALSE(estimate.jackknife);
  EXPECT_NE(estimate.jackknife.reason().find("not 3"), std::string::npos);
}

TEST(DirectFit, LeavesOutSettingsBeyondTheReachOfTheCurve) {
  // 33 exp(0.04 delta) is 60 at delta = 15 and 73 at 20; the grid ends at 50.
  const stats::PilotTable table(simulated::pilot({33, 0.04}, 40, 1));
  const auto estimate = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0});
  ASSERT_TRUE(estimate.jackknife) << estimate.jackknife.reason();
  EXPECT_EQ(estimate.out_of_reach, (std::vector<double>{15, 20}));
  EXPECT_EQ(estimate.fit->n, 40 * 14);
  const stats::PilotTable inner(simulated::pilot({24, 0.02}, 16, 1));
  EXPECT_TRUE(
      stats::estimate_direct(inner.observations(stats::PilotMean::Harmonic), 4, {0}).out_of_reach.empty());
}

TEST(DirectFit, IdenticalParticipantsLeaveNoSpread) {
  std::vector<PilotObservation> data;
  for (int p = 0; p < 6; ++p) {
    for (auto o : surface(model(24, 0.02, 3, 0.04, 0.4), 1, 0, 1)) {
      o.participant = p;
      data.push_back(o);
    }
  }
  const auto estimate = stats::estimate_direct(data, 4, {100, 1, 0.95});
  ASSERT_TRUE(estimate.jackknife);
  EXPECT_NEAR(estimate.jackknife->a_se(), 0, 1e-7);
  EXPECT_NEAR(estimate.bootstrap->a_se, 0, 1e-7);
}

TEST(Curve, BandIsTheIntervalOfAAtZeroAndWidensAwayFromTheMiddle) {
  const stats::PilotTable table(simulated::pilot({24, 0.02}, 16, 5));
  const auto estimate = stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0});
  ASSERT_TRUE(estimate.jackknife);
  const auto& spread = *estimate.jackknife;
  EXPECT_EQ(spread.band(0).pointwise, spread.a_ci);
  const auto width = [&](double delta) {
    const auto at = spread.band(delta);
    EXPECT_LT(at.simultaneous[0], at.pointwise[0]);
    EXPECT_GT(at.simultaneous[1], at.pointwise[1]);
    return std::log(at.pointwise[1] / at.pointwise[0]);
  };
  const double narrowest = -spread.cov / spread.var_b;
  EXPECT_GT(narrowest, 0);
  EXPECT_LT(width(narrowest), width(narrowest - 5));
  EXPECT_LT(width(narrowest), width(narrowest + 5));
  EXPECT_GE(spread.largest_relative_half_width(std::vector<double>{0, 10, 20}),
            (spread.a_ci[1] - spread.a_ci[0]) / 2 / spread.curve.a());
}

TEST(Curve, JackknifeOfAMeanIsItsStandardError) {
  const std::vector<double> x{3, 1, 4, 1, 5, 9, 2, 6};
  double mean = 0, squares = 0;
  for (const double v : x) mean += v / 8;
  for (const double v : x) squares += (v - mean) * (v - mean);
  std::vector<double> without;
  for (const double v : x) without.push_back((8 * mean - v) / 7);
  EXPECT_NEAR(stats::jackknife_covariance(without, without), squares / 7 / 8, 1e-12);
  EXPECT_THROW(stats::jackknife_covariance(x, std::vector<double>{1}), std::invalid_argument);
}

// 600 pilots of a straight surface: the test's p are uniform (Kolmogorov-Smirnov, 1 % point). For a bent
// surface the test rejects.
TEST(LackOfFit, HoldsItsLevelAndFindsABend) {
  constexpr int studies = 600;
  std::vector<double> p;
  int found = 0;
  for (int i = 0; i < studies; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const auto straight = surface(model(24, 0.02, 2, 0, 0), 16, 0.5, 1, seed);
    p.push_back(stats::estimate_direct(straight, 4, {0}).lack_of_fit->p);
    const auto bent = surface(model(24, 0.02, 2, 0.1, 0.6), 16, 0.5, 1, seed);
    found += stats::estimate_direct(bent, 4, {0}).lack_of_fit->p < 0.05;
  }
  std::sort(p.begin(), p.end());
  double distance = 0;
  for (int i = 0; i < studies; ++i) {
    distance = std::max({distance, std::abs(p[static_cast<std::size_t>(i)] - i / double{studies}),
                         std::abs(p[static_cast<std::size_t>(i)] - (i + 1) / double{studies})});
  }
  EXPECT_LT(distance, 1.63 / std::sqrt(studies));
  EXPECT_GT(found, 0.9 * studies);
}

// Scores rounded to the scale, 400 pilots each: an even rise is rejected at the test's level; the parametric
// observer's scores, which level off in log mu, nearly always.
TEST(LackOfFit, AsksForAnEvenRiseOfTheScoresAlsoWhenTheyAreRounded) {
  constexpr int studies = 400;
  int even = 0, observer = 0;
  for (int i = 0; i < studies; ++i) {
    const auto seed = static_cast<std::uint64_t>(i) + 1;
    auto rounded = surface(model(24, 0.02, 2, 0, 0), 16, 0.5, 1, seed);
    for (auto& o : rounded) o.score = std::clamp(std::round(o.score), 1.0, 7.0);
    even += stats::estimate_direct(rounded, 4, {0}).lack_of_fit->p < 0.05;
    const auto bent =
        stats::PilotTable(simulated::pilot({24, 0.02}, 16, seed)).observations(stats::PilotMean::Harmonic);
    observer += stats::estimate_direct(bent, 4, {0}).lack_of_fit->p < 0.05;
  }
  const double spread = std::sqrt(studies * 0.05 * 0.95);
  EXPECT_NEAR(even, studies * 0.05, 3.5 * spread);
  EXPECT_GT(observer, 0.95 * studies);
}

// Scores level off towards the top of the scale. A quadratic that follows them there misses the frame rate at
// which the score is 4: with all settings the estimate of a would be 16.6 instead of 18 here.
TEST(DirectFit, WhatLiesFarAboveTheCurveDoesNotBendIt) {
  constexpr int pilots = 20;
  double mean = 0;
  for (std::uint64_t seed = 1; seed <= pilots; ++seed) {
    const stats::PilotTable table(simulated::pilot({18, 0.01}, 40, seed));
    const auto estimate =
        stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0, 1, 0.95});
    ASSERT_TRUE(estimate.fit) << estimate.fit.reason();
    EXPECT_GT(estimate.far_above, 0);
    mean += estimate.fit->curve.a() / pilots;
  }
  EXPECT_NEAR(mean, 18, 0.8);
}

TEST(DirectFit, SettingsNearTheCurveAllCount) {
  const stats::PilotTable table(simulated::pilot({30, 0.02}, 16, 1));
  const auto observations = table.observations(stats::PilotMean::Harmonic);
  EXPECT_EQ(stats::within_reach(observations, 4).far_above, 0);
  EXPECT_EQ(stats::within_reach(observations, 4).kept.size(), observations.size());
}

}  // namespace
