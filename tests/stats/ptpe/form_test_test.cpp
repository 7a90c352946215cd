/// The test whether the threshold mu of the mean frame rate is an exponential of the rate's deviation delta:
/// the bend of log mu, its interval, and the smallest bend that the test detects.
#include "stats/ptpe/form_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "stats/inference/power.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "tests/stats/ptpe/surfaces.hpp"

namespace {

using ::testing::HasSubstr;

stats::DirectEstimate estimate(const surfaces::Population& population, int people, std::uint64_t seed) {
  const stats::PilotTable table(surfaces::pilot(population, people, seed));
  return stats::estimate_direct(table.observations(stats::PilotMean::Harmonic), 4, {0});
}

/// Unrounded scores of a quadratic surface about the curve log mu = log 26 + 0.02 delta + c (e^2 - 1/2), e =
/// (delta - 10) / 10, with differences between people.
std::vector<stats::PilotObservation> on_the_family(double c, int people) {
  std::vector<stats::PilotObservation> out;
  for (int p = 0; p < people; ++p) {
    for (const double mu : surfaces::rates) {
      for (const double delta : surfaces::deviations) {
        if (delta >= mu) continue;
        const double e = (delta - 10) / 10, person = 0.05 * ((p * 7 % 5) - 2);
        const double u =
            std::log(mu) - std::log(26) - 0.02 * delta - (c + person) * (e * e - 0.5) - 0.3 * person;
        out.push_back({p, mu, delta, 4 + u * (3 + 0.4 * e - 0.5 * u), delta, mu});
      }
    }
  }
  return out;
}

TEST(FormTest, FindsTheBendOfACurveOfItsFamily) {
  for (const double c : {-0.2, 0.0, 0.15}) {
    const auto test = stats::form_test(on_the_family(c, 10), {std::log(26), 0.02}, 4, 0.95);
    ASSERT_TRUE(test) << test.reason();
    EXPECT_NEAR(test->c, c, 0.005);
    EXPECT_NEAR(test->curve.middle, 10, 1e-12);
    for (const double delta : {0.0, 10.0, 20.0}) {
      const double e = (delta - 10) / 10;
      EXPECT_NEAR(std::log(test->curve.mu(delta)), std::log(26) + 0.02 * delta + c * (e * e - 0.5), 0.01);
      const auto band = test->curve.band(delta);
      EXPECT_LT(band.simultaneous[0], band.pointwise[0]);
      EXPECT_LT(band.pointwise[0], band.mu);
      EXPECT_GT(band.simultaneous[1], band.pointwise[1]);
    }
  }
}

TEST(FormTest, PAndIntervalAgree) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    const auto direct = estimate(surfaces::with_threshold("linear", surfaces::linear), 12, seed);
    ASSERT_TRUE(direct.form) << direct.form.reason();
    const auto& test = *direct.form;
    EXPECT_EQ(test.rejected(), test.ci[0] > 0 || test.ci[1] < 0);
    EXPECT_NEAR(test.t, test.c / test.se, 1e-12);
    EXPECT_EQ(test.df, 11);
    // A true bend of size `detectable` is found with the promised power.
    const double d = test.detectable / test.se / std::sqrt(12.0);
    EXPECT_NEAR(*stats::t_power(12, d, stats::form_level, stats::Design::OneSample), stats::form_power, 1e-6);
  }
}

TEST(FormTest, RejectsACurveThatLevelsOffAndAHingeAndKeepsAnExponential) {
  const auto saturating = estimate(surfaces::with_threshold("", surfaces::saturating), 16, 1);
  ASSERT_TRUE(saturating.form);
  EXPECT_TRUE(saturating.form->rejected());
  EXPECT_LT(saturating.form->c, 0);
  const auto hinged = estimate(surfaces::with_threshold("", surfaces::hinged), 16, 1);
  ASSERT_TRUE(hinged.form);
  EXPECT_TRUE(hinged.form->rejected());
  EXPECT_GT(hinged.form->c, 0);
  const auto exponential = estimate(surfaces::parametric(23.68, 0.02), 16, 1);
  ASSERT_TRUE(exponential.form);
  EXPECT_FALSE(exponential.form->rejected());
}

// If the curve is not exponential, the free curve's band holds the truth where the exponential's does not.
TEST(FormTest, TheFreeCurveHoldsASaturatingThreshold) {
  int free = 0, exponential = 0;
  const auto truth = surfaces::saturating;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto direct = estimate(surfaces::with_threshold("", truth), 16, seed);
    ASSERT_TRUE(direct.form) << direct.form.reason();
    const auto a = direct.form->curve.band(10).pointwise, b = direct.jackknife->band(10).pointwise;
    free += a[0] <= truth(10) && truth(10) <= a[1];
    exponential += b[0] <= truth(10) && truth(10) <= b[1];
  }
  EXPECT_GE(free, 30);
  EXPECT_LE(exponential, 25);
}

TEST(FormTest, SaysWhyItCannotTest) {
  const auto few = stats::form_test(on_the_family(0, 3), {std::log(26), 0.02}, 4, 0.95);
  EXPECT_THAT(few.reason(), HasSubstr("at least 4"));
  auto two = on_the_family(0, 6);
  std::erase_if(two, [](const auto& o) { return o.nominal_delta > 5; });
  EXPECT_THAT(stats::form_test(two, {std::log(26), 0.02}, 4, 0.95).reason(), HasSubstr("fewer than three"));
  std::vector<stats::PilotObservation> alike;
  for (int p = 0; p < 6; ++p)
    for (auto o : on_the_family(0, 1)) {
      o.participant = p;
      alike.push_back(o);
    }
  EXPECT_THAT(stats::form_test(alike, {std::log(26), 0.02}, 4, 0.95).reason(), HasSubstr("agree"));
}

}  // namespace
