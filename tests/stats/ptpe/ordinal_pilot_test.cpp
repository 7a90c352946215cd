#include "stats/ptpe/ordinal_pilot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/quantiles.hpp"
#include "tests/stats/ptpe/simulated_ratings.hpp"

namespace {

using stats::OrdinalPilotFit;
using stats::PilotMean;

/// The population's mean score on the fitted curve.
double mean_on_the_curve(const OrdinalPilotFit& fit) {
  const double s = std::sqrt(1 + fit.sd_participant * fit.sd_participant);
  double mean = fit.levels[0];
  for (std::size_t j = 0; j < fit.thresholds.size(); ++j)
    mean += (fit.levels[j + 1] - fit.levels[j]) * stats::normal_probability(-fit.thresholds[j] / s);
  return mean;
}

double log_likelihood(const OrdinalPilotFit& fit, const std::vector<stats::PilotRating>& ratings) {
  std::vector<int> category, participant;
  std::vector<double> location;
  for (const auto& r : ratings) {
    const auto at = std::lower_bound(fit.levels.begin(), fit.levels.end(), r.score);
    category.push_back(static_cast<int>(at - fit.levels.begin()));
    participant.push_back(r.participant);
    const double u = std::log(r.realised_mu) - fit.curve.log_a - fit.curve.b * r.realised_delta;
    location.push_back(u * (fit.k + fit.m * r.realised_delta + fit.q * u));
  }
  stats::MixedLikelihood likelihood(category, participant, stats::Link::Probit, 1);
  stats::MixedGradient ignored;
  return likelihood.evaluate(fit.thresholds, location, fit.sd_participant, ignored);
}

TEST(OrdinalPilot, MeetsTheLevelOnItsCurveAndNothingNearbyIsLikelier) {
  const auto ratings = simulated::pilot({24, 0.02}, 8, 3);
  for (const double level : {4.0, 5.0}) {
    const auto fit = stats::fit_ordinal_pilot(ratings, PilotMean::Harmonic, level);
    ASSERT_TRUE(fit) << fit.reason();
    EXPECT_NEAR(mean_on_the_curve(*fit), level, 1e-9);
    EXPECT_NEAR(log_likelihood(*fit, ratings), fit->log_likelihood, 1e-8);
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 400; ++i) {
      auto other = *fit;
      const double reach = std::pow(10, -i % 4);
      other.curve.log_a += 0.1 * reach * normal(engine);
      other.curve.b += 0.005 * reach * normal(engine);
      other.k += 0.3 * reach * normal(engine);
      other.m += 0.02 * reach * normal(engine);
      other.q += 0.3 * reach * normal(engine);
      other.sd_participant = std::abs(other.sd_participant + 0.1 * reach * normal(engine));
      for (double& t : other.thresholds) t += 0.03 * reach * normal(engine);
      double low = -20, high = 20;
      const auto thresholds = other.thresholds;
      for (int halving = 0; halving < 60; ++halving) {
        const double shift = (low + high) / 2;
        for (std::size_t j = 0; j < thresholds.size(); ++j) other.thresholds[j] = thresholds[j] + shift;
        (mean_on_the_curve(other) > level ? low : high) = shift;
      }
      EXPECT_LE(log_likelihood(other, ratings), fit->log_likelihood + 1e-9);
    }
  }
}

TEST(OrdinalPilot, FindsTheObserversTruth) {
  const auto ratings = simulated::pilot({24, 0.02}, 60, 1);
  const auto fit = stats::fit_ordinal_pilot(ratings, PilotMean::Harmonic, 4);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->curve.a(), 24, 2);
  EXPECT_NEAR(fit->curve.b, 0.02, 0.004);
  EXPECT_NEAR(fit->sd_participant, 0.5, 0.2);
  EXPECT_GT(fit->k, 0);
}

TEST(OrdinalPilot, JackknifeHoldsTheEstimate) {
  const auto ratings = simulated::pilot({24, 0.02}, 6, 2);
  const auto estimate = stats::estimate_ordinal_pilot(ratings, PilotMean::Harmonic, 4, 0.95);
  ASSERT_TRUE(estimate.jackknife) << estimate.jackknife.reason();
  EXPECT_LT(estimate.jackknife->a_ci[0], estimate.fit->curve.a());
  EXPECT_GT(estimate.jackknife->b_ci[1], estimate.fit->curve.b);
}

// A linear change of the scale moves the thresholds and the level, but not the curve.
TEST(OrdinalPilot, TurningTheScaleRoundIsRefusedAndShiftingItIsNot) {
  auto ratings = simulated::pilot({24, 0.02}, 8, 3);
  const auto fit = stats::fit_ordinal_pilot(ratings, PilotMean::Harmonic, 4);
  for (auto& r : ratings) r.score = 2 * r.score + 1;
  const auto stretched = stats::fit_ordinal_pilot(ratings, PilotMean::Harmonic, 9);
  ASSERT_TRUE(stretched) << stretched.reason();
  EXPECT_NEAR(stretched->curve.a(), fit->curve.a(), 1e-4);
  EXPECT_NEAR(stretched->curve.b, fit->curve.b, 1e-6);
  EXPECT_NEAR(stretched->log_likelihood, fit->log_likelihood, 1e-7);
  for (auto& r : ratings) r.score = -r.score;
  EXPECT_FALSE(stats::fit_ordinal_pilot(ratings, PilotMean::Harmonic, -9));
}

TEST(OrdinalPilot, RefusesWithAReason) {
  const auto reason = [](const std::vector<stats::PilotRating>& ratings, double level = 4) {
    const auto estimate = stats::estimate_ordinal_pilot(ratings, PilotMean::Harmonic, level, 0.95);
    EXPECT_FALSE(estimate.jackknife);
    EXPECT_FALSE(estimate.jackknife.reason().empty());
    return estimate.fit.reason();
  };
  EXPECT_EQ(reason({}), "no ratings");
  auto ratings = simulated::pilot({24, 0.02}, 6, 2);
  EXPECT_NE(reason(ratings, 7.5).find("level"), std::string::npos);
  auto alone = ratings;
  std::erase_if(alone, [](const auto& r) { return r.participant > 2; });
  EXPECT_TRUE(reason(alone).empty());
  for (auto& r : ratings) r.score = 4;
  EXPECT_NE(reason(ratings).find("equal"), std::string::npos);
}

}  // namespace
