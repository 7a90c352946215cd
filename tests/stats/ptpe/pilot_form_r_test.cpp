/// Results of fit-ptpe for whole pilots against R (tests/stats/r/pilot_form.R): the direct estimate, the band
/// of the solver's file, the test of the curve's form, slopes within people and drift.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/form_test.hpp"
#include "stats/ptpe/pilot_people.hpp"
#include "stats/ptpe/scale_end_fit.hpp"

namespace {

/// Rows of person, mu, delta, position, score.
std::vector<stats::PilotRating> ratings_of(const std::vector<double>& rows) {
  std::vector<stats::PilotRating> out;
  for (std::size_t i = 0; i + 4 < rows.size(); i += 5)
    out.push_back({static_cast<int>(rows[i]), rows[i + 1], rows[i + 2], rows[i + 1], rows[i + 1], rows[i + 2],
                   rows[i + 4], static_cast<int>(rows[i + 3])});
  return out;
}

/// `relative`: a relative tolerance, the precision of R's nls.
void expect_interval(const std::array<double, 2>& got, double low, double high, double relative) {
  EXPECT_NEAR(got[0], low, relative * std::abs(low) + 2e-8);
  EXPECT_NEAR(got[1], high, relative * std::abs(high) + 2e-8);
}

void expect_form(const std::vector<stats::PilotObservation>& observations, const base::Json& study) {
  const auto form = stats::form_test(observations, {std::log(26), 0.02}, 4, 0.95);
  ASSERT_TRUE(form) << form.reason();
  EXPECT_NEAR(form->c, study.at("c"), 1e-6);
  EXPECT_NEAR(form->se, study.at("se"), 1e-6);
  EXPECT_NEAR(form->p, study.at("p"), 1e-5);
}

void expect_estimates(const std::vector<stats::PilotObservation>& observations, const base::Json& study) {
  const auto direct = stats::estimate_direct(observations, 4, {0});
  ASSERT_TRUE(direct.jackknife) << direct.jackknife.reason();
  EXPECT_EQ(direct.out_of_reach, study.at("out_of_reach").get<std::vector<double>>());
  EXPECT_NEAR(direct.fit->curve.a(), study.at("a"), 1e-5);
  EXPECT_NEAR(direct.fit->curve.b, study.at("b"), 1e-8);
  expect_interval(direct.jackknife->a_ci, study.at("a_ci")[0], study.at("a_ci")[1], 2e-6);
  expect_interval(direct.jackknife->b_ci, study.at("b_ci")[0], study.at("b_ci")[1], 2e-6);
  const auto band = stats::scale_end_curve(observations, direct, 4, {1, 7});
  ASSERT_TRUE(band) << band.reason();
  for (std::size_t i = 0; i < 5; ++i)
    expect_interval(band->band(5.0 * static_cast<double>(i)).pointwise, study.at("band_low")[i],
                    study.at("band_high")[i], 1e-5);
}

TEST(PilotForm, AgreesWithR) {
  const auto made =
      base::Json::parse(base::read_file(std::string(VIP_TEST_DIR) + "/stats/r/pilot_form.json", 1 << 20));
  int seen = 0;
  for (const auto& study : made.at("studies")) {
    const auto ratings = ratings_of(study.at("rows"));
    const auto observations = stats::PilotTable(ratings).observations(stats::PilotMean::Harmonic);
    SCOPED_TRACE(seen);
    expect_estimates(observations, study);
    if (!study.at("c").is_null()) expect_form(observations, study);
    const auto people = stats::pilot_people(ratings, 0.95);
    ASSERT_EQ(people.slopes.size(), study.at("slopes_t").size());
    for (std::size_t i = 0; i < people.slopes.size(); ++i)
      EXPECT_NEAR(people.slopes[i].t, study.at("slopes_t")[i], 1e-9);
    ASSERT_TRUE(people.drift);
    EXPECT_NEAR(people.drift->change, study.at("drift"), 1e-10);
    EXPECT_NEAR(people.drift->p, study.at("drift_p"), 1e-10);
    ++seen;
  }
  EXPECT_EQ(seen, 5);
}

}  // namespace
