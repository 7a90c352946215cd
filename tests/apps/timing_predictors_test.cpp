/// The numbers of a trial's timing that people may notice, and the names of the models made of them.

#include "libstudy/analysis/timing_predictors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "stats/base/error.hpp"

namespace {

using study::TimingPredictor;

double of(const std::vector<double>& intervals_s, TimingPredictor which) {
  return study::timing_predictors(intervals_s)[static_cast<std::size_t>(which)];
}

TEST(TimingPredictors, OfFewFramesAreThoseOfHand) {
  const std::vector<double> four{0.01, 0.02, 0.01, 0.04};  // 80 ms; rates 100, 50, 100, 25
  EXPECT_NEAR(of(four, TimingPredictor::MeanRate), std::log(50), 1e-12);
  EXPECT_NEAR(of(four, TimingPredictor::ArithmeticRate), std::log(68.75), 1e-12);
  EXPECT_NEAR(of(four, TimingPredictor::RateSd),
              std::sqrt((2 * 31.25 * 31.25 + 18.75 * 18.75 + 43.75 * 43.75) / 4), 1e-9);
  EXPECT_NEAR(of(four, TimingPredictor::FrameTimeSd), std::sqrt((100 + 0 + 100 + 400) / 4.0), 1e-9);
  EXPECT_NEAR(of(four, TimingPredictor::P95), std::log(1000 / (20 + 0.85 * 20)), 1e-9);
  EXPECT_NEAR(of(four, TimingPredictor::P99), std::log(1000 / (20 + 0.97 * 20)), 1e-9);
  EXPECT_NEAR(of(four, TimingPredictor::Longest), std::log(25), 1e-12);
  EXPECT_NEAR(of(four, TimingPredictor::Hitches), std::log(2), 1e-12) << "one above 1.5 * 15 ms";
  EXPECT_NEAR(of(four, TimingPredictor::Steps), std::log1p(std::sqrt((100 + 100 + 900) / 3.0)), 1e-9);
}

TEST(TimingPredictors, OnlyStepsDependOnTheOrder) {
  const std::vector<double> a{0.01, 0.03, 0.01, 0.03, 0.02}, b{0.01, 0.01, 0.02, 0.03, 0.03};
  const auto x = study::timing_predictors(a), y = study::timing_predictors(b);
  constexpr auto steps = static_cast<std::size_t>(TimingPredictor::Steps);
  for (std::size_t i = 0; i < steps; ++i) EXPECT_NEAR(x[i], y[i], 1e-9) << i;
  EXPECT_GT(x[steps], y[steps]);
}

TEST(TimingPredictors, RefuseNoFramesAndOneFrameIsDefined) {
  EXPECT_THROW(study::timing_predictors({}), std::invalid_argument);
  EXPECT_THROW(study::timing_predictors(std::vector<double>{0.01, 0}), std::invalid_argument);
  for (const double v : study::timing_predictors(std::vector<double>{0.02}, 0)) EXPECT_TRUE(std::isfinite(v));
}

TEST(TimingPredictors, AnimationErrorIsTheRecordedOneOrNone) {
  constexpr auto error = static_cast<std::size_t>(TimingPredictor::AnimationError);
  const std::vector<double> one{0.02};
  EXPECT_NEAR(study::timing_predictors(one, 9)[error], std::log(10), 1e-12);
  EXPECT_TRUE(std::isnan(study::timing_predictors(one)[error]));
}

TEST(TimingModels, AreReadByName) {
  const auto models = study::parse_timing_models("ptpe,p95,longest+hitches");
  ASSERT_EQ(models.size(), 3u);
  EXPECT_EQ(models[0].predictors, (std::vector{TimingPredictor::MeanRate, TimingPredictor::RateSd}));
  EXPECT_EQ(models[2].predictors, (std::vector{TimingPredictor::Longest, TimingPredictor::Hitches}));
  EXPECT_TRUE(study::contains(models[2], study::parse_timing_models("longest,p95")[0]));
  EXPECT_FALSE(study::contains(models[0], models[1]));
  EXPECT_EQ(study::usual_timing_models().size(), 8u);
  for (const char* wrong : {"", "ptpe", "ptpe,", "ptpe,p96", "p95,p95", "ptpe,mean_rate+rate_sd",
                            "p95,p95+p95", "p95,p99+longest+hitches", "p95,+", "p95, p99"})
    EXPECT_THROW(study::parse_timing_models(wrong), base::Error) << wrong;
}

}  // namespace
