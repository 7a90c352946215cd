/// The form of the curve, slopes within people and drift, as R computes them (tests/stats/r/pilot_form.R).

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/ptpe/form_test.hpp"
#include "stats/ptpe/pilot_people.hpp"

namespace {

/// Rows of person, mu, delta, position, score.
std::vector<stats::PilotRating> ratings_of(const std::vector<double>& rows) {
  std::vector<stats::PilotRating> out;
  for (std::size_t i = 0; i + 4 < rows.size(); i += 5)
    out.push_back({static_cast<int>(rows[i]), rows[i + 1], rows[i + 2], rows[i + 1], rows[i + 1], rows[i + 2],
                   rows[i + 4], static_cast<int>(rows[i + 3])});
  return out;
}

TEST(PilotForm, AgreesWithR) {
  const auto made =
      nlohmann::json::parse(base::read_file(std::string(VIP_TEST_DIR) + "/stats/r/pilot_form.json", 1 << 20));
  int seen = 0;
  for (const auto& study : made.at("studies")) {
    const auto ratings = ratings_of(study.at("rows"));
    const auto observations = stats::PilotTable(ratings).observations(stats::PilotMean::Harmonic);
    const auto form = stats::form_test(observations, {std::log(26), 0.02}, 4, 0.95);
    ASSERT_TRUE(form) << form.reason();
    EXPECT_NEAR(form->c, study.at("c"), 1e-6);
    EXPECT_NEAR(form->se, study.at("se"), 1e-6);
    EXPECT_NEAR(form->p, study.at("p"), 1e-5);
    const auto people = stats::pilot_people(ratings, 0.95);
    ASSERT_EQ(people.slopes.size(), study.at("slopes_t").size());
    for (std::size_t i = 0; i < people.slopes.size(); ++i)
      EXPECT_NEAR(people.slopes[i].t, study.at("slopes_t")[i], 1e-9);
    ASSERT_TRUE(people.drift);
    EXPECT_NEAR(people.drift->change, study.at("drift"), 1e-10);
    EXPECT_NEAR(people.drift->p, study.at("drift_p"), 1e-10);
    ++seen;
  }
  EXPECT_EQ(seen, 3);
}

}  // namespace
