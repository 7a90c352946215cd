/// The fit of the threshold curve whose confidence bands go into the solver's file: scores may level off at
/// the ends of the rating scale.

#include "stats/ptpe/scale_end_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "stats/ptpe/pilot_doubts.hpp"
#include "tests/stats/ptpe/surfaces.hpp"

namespace {

constexpr stats::ScaleEnds one_to_seven{1, 7};

std::vector<stats::PilotObservation> observed(const std::vector<stats::PilotRating>& ratings) {
  return stats::PilotTable(ratings).observations(stats::PilotMean::Harmonic);
}

/// log mu(delta) less that of the truth, in standard errors.
double standard_errors_off(const stats::CurveSpread& curve, double delta, double truth) {
  const auto point = curve.band(delta);
  const double t = stats::student_quantile(0.975, curve.participants - 1);
  return std::log(point.mu / truth) / (std::log(point.pointwise[1] / point.mu) / t);
}

// This observer's scores level off where the curve is steepest, which biases the direct estimate.
TEST(ScaleEndFit, IsNotDrawnOffByTheEndsOfTheScale) {
  constexpr int pilots = 60;
  constexpr double delta = 20;
  const auto population = surfaces::parametric(24, 0.03);
  const double truth = surfaces::mean_threshold(population, delta);
  double direct_off = 0, off = 0;
  for (unsigned seed = 1; seed <= pilots; ++seed) {
    const auto observations = observed(surfaces::pilot(population, 16, seed));
    const auto direct = stats::estimate_direct(observations, 4, {0});
    ASSERT_TRUE(direct.jackknife) << seed;
    const auto curve = stats::scale_end_curve(observations, direct, 4, one_to_seven);
    ASSERT_TRUE(curve) << seed << curve.reason();
    direct_off += standard_errors_off(*direct.jackknife, delta, truth) / pilots;
    off += standard_errors_off(*curve, delta, truth) / pilots;
  }
  EXPECT_LT(direct_off, -0.35);
  EXPECT_LT(std::abs(off), 0.25);
}

TEST(ScaleEndFit, TakesTheScoresOfAnyScale) {
  auto ratings = surfaces::pilot(surfaces::parametric(24, 0.02), 16, 3);
  const auto curve_of = [&](double level, const stats::ScaleEnds& ends) {
    const auto observations = observed(ratings);
    return stats::scale_end_curve(observations, stats::estimate_direct(observations, level, {0}), level,
                                  ends);
  };
  const auto before = curve_of(4, one_to_seven);
  ASSERT_TRUE(before) << before.reason();
  for (auto& rating : ratings) rating.score += 10;
  const auto after = curve_of(14, {11, 17});
  ASSERT_TRUE(after) << after.reason();
  for (const double delta : surfaces::deviations)
    EXPECT_NEAR(after->band(delta).pointwise[0], before->band(delta).pointwise[0], 1e-6);
}

TEST(ScaleEndFit, SaysWhyThereIsNone) {
  const auto observations = observed(surfaces::pilot(surfaces::parametric(24, 0.02), 16, 1));
  const auto direct = stats::estimate_direct(observations, 4, {0});
  EXPECT_EQ(stats::scale_end_curve(observations, direct, 7, one_to_seven).reason(),
            "the level lies outside the scale");
  const auto three = observed(surfaces::pilot(surfaces::parametric(24, 0.02), 3, 1));
  const auto few = stats::scale_end_curve(three, stats::estimate_direct(three, 4, {0}), 4, one_to_seven);
  EXPECT_NE(few.reason().find("at least 4"), std::string::npos) << few.reason();
  auto alike = observations;
  for (auto& one : alike) one.score = std::clamp(std::round(4 + 0.14 * (one.mu - 24)), 1.0, 7.0);
  const auto same = stats::scale_end_curve(alike, stats::estimate_direct(alike, 4, {0}), 4, one_to_seven);
  EXPECT_NE(same.reason().find("rated differently"), std::string::npos) << same.reason();
}

TEST(ScaleEndFit, ACurveOutsideItsBandIsDoubted) {
  const auto observations = observed(surfaces::pilot(surfaces::parametric(24, 0.02), 16, 1));
  const auto direct = stats::estimate_direct(observations, 4, {0});
  const auto band = stats::scale_end_curve(observations, direct, 4, one_to_seven);
  ASSERT_TRUE(band) << band.reason();
  EXPECT_FALSE(stats::band_doubt(direct.fit->curve, band, surfaces::deviations));
  auto away = direct.fit->curve;
  away.b += 0.02;
  const auto doubt = stats::band_doubt(away, band, surfaces::deviations);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->code, "curve_outside_band");
  EXPECT_EQ(stats::band_doubt(away, stats::Refusal{"none"}, surfaces::deviations)->code, "no_band");
}

}  // namespace
