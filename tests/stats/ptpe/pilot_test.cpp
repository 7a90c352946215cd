#include "stats/ptpe/pilot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using json = base::Json;
using stats::ContourPoint;
using stats::PilotRating;
using stats::ScoreGrid;

/// Reads columns participant, fps_mean, fps_sd, rating. The realised moments are the nominal ones.
std::vector<PilotRating> read_csv(const std::string& name) {
  std::ifstream in(oracle::folder() / name);
  std::vector<PilotRating> ratings;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    PilotRating r;
    cells >> r.participant >> r.mu >> r.delta >> r.score;
    r.realised_mu = r.realised_mu_arithmetic = r.mu;
    r.realised_delta = r.delta;
    ratings.push_back(r);
  }
  return ratings;
}

ScoreGrid read_grid(const json& rows) {
  ScoreGrid grid{{10, 20, 30, 40, 50}, {0, 5, 10, 15, 20}, {}};
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 5; ++column) {
      const auto& cell = rows.at(row).at(column);
      grid.nodes.push_back(cell.is_null() ? std::nullopt
                                          : std::make_optional(stats::GridNode{
                                                cell.get<double>(), grid.mu[row], grid.delta[column]}));
    }
  }
  return grid;
}

void expect_points(const std::vector<ContourPoint>& got, const json& expected, double rtol,
                   const std::string& where) {
  ASSERT_EQ(got.size(), expected.size()) << where;
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_NEAR(got[i].delta, expected[i][0].get<double>(), oracle::bound(expected[i][0], rtol, 1)) << where;
    EXPECT_NEAR(got[i].mu, expected[i][1].get<double>(), oracle::bound(expected[i][1], rtol, 1)) << where;
  }
}

void expect_fit(const stats::Result<stats::ExponentialFit>& got, const json& expected, double rtol,
                const std::string& where) {
  if (expected.at("status") == "undefined") {
    EXPECT_FALSE(got) << where;
    EXPECT_FALSE(got.reason().empty()) << where;
    return;
  }
  ASSERT_TRUE(got) << where << ": " << got.reason();
  EXPECT_NEAR(got->a, expected["a"], oracle::bound(expected["a"], rtol, 1)) << where;
  EXPECT_NEAR(got->b, expected["b"], oracle::bound(expected["b"], rtol, 1)) << where;
  EXPECT_NEAR(got->rss, expected["rss"], oracle::bound(expected["rss"], rtol, 1)) << where;
  EXPECT_NEAR(std::sqrt(got->covariance->aa), expected["se"][0], oracle::bound(expected["se"][0], rtol, 1));
  EXPECT_NEAR(std::sqrt(got->covariance->bb), expected["se"][1], oracle::bound(expected["se"][1], rtol, 1));
}

/// Predictors of the model in which scores are linear in log mu and delta (the straight form).
std::vector<stats::Predictor> predictors(const std::vector<PilotRating>& ratings) {
  std::vector<stats::Predictor> out{{"log(fps_mean)", {}}, {"fps_sd", {}}};
  for (const auto& r : ratings) {
    out[0].values.push_back(std::log(r.mu));
    out[1].values.push_back(r.delta);
  }
  return out;
}

/// Compares the straight form (scores linear in log mu and delta) with ordinary least squares by the
/// reference.
void expect_straight(const json& item, const std::vector<PilotRating>& ratings) {
  const auto& expect = item.at("expect");
  if (!oracle::asks(expect, "ols_coef")) return;
  const auto observations = stats::PilotTable(ratings).observations(stats::PilotMean::Harmonic);
  const auto fit = stats::DirectModel(observations, 4).fit_straight();
  ASSERT_TRUE(fit) << fit.reason();
  const std::vector<double> coefficients{4 - fit->k * fit->curve.log_a, fit->k, -fit->k * fit->curve.b};
  for (std::size_t i = 0; i < 3; ++i) {
    oracle::expect_number("ols_coef", coefficients[i], expect["ols_coef"][i], item.at("rtol"));
  }
  oracle::expect_field(item, "ols_level4_a", fit->curve.a());
  oracle::expect_field(item, "ols_level4_b", fit->curve.b);
}

/// oracle/README.md has the tolerance of thresholds and coefficients: 1e-5.
void expect_cumulative_link(const json& item, const std::vector<PilotRating>& ratings) {
  if (!oracle::asks(item.at("expect"), "clm_probit")) return;
  const auto& expect = item["expect"]["clm_probit"];
  std::vector<double> scores;
  for (const auto& r : ratings) scores.push_back(r.score);
  const auto fit = stats::fit_cumulative_link(scores, predictors(ratings), stats::Link::Probit);
  ASSERT_TRUE(fit) << fit.reason();
  auto coefficients = fit->thresholds;
  coefficients.insert(coefficients.end(), fit->beta.begin(), fit->beta.end());
  const auto se = fit->se();
  ASSERT_EQ(coefficients.size(), expect.at("coef").size());
  for (std::size_t i = 0; i < se.size(); ++i) {
    oracle::expect_number("coef", coefficients[i], expect["coef"][i], 1e-5);
    if (oracle::asks(expect, "se")) oracle::expect_number("se", se[i], expect["se"][i], 1e-5);
  }
  oracle::expect_number("loglik", fit->log_likelihood, expect.at("loglik"), 1e-8);
}

void expect_pipeline(const json& item) {
  const auto& expect = item.at("expect");
  const double rtol = item.at("rtol");
  const auto ratings = read_csv(item.at("input").at("csv"));
  expect_straight(item, ratings);
  expect_cumulative_link(item, ratings);
  const stats::PilotTable table(ratings);
  const auto grid = table.grid(stats::PilotMean::Harmonic);
  const auto wanted = read_grid(expect.at("grid_rows_mu10_50_cols_delta0_20"));
  ASSERT_EQ(grid.nodes.size(), wanted.nodes.size());
  for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
    ASSERT_EQ(grid.nodes[i].has_value(), wanted.nodes[i].has_value());
    if (grid.nodes[i]) {
      EXPECT_NEAR(grid.nodes[i]->score, wanted.nodes[i]->score, rtol);
    }
  }
  for (const int level : {4, 5}) {
    const std::string key = "level" + std::to_string(level);
    const std::string where = std::string(item.at("id")) + ' ' + key;
    const auto& at = expect.at(key);
    const auto columns = stats::column_crossings(grid, level, stats::contour_lines(grid));
    expect_points(columns.points, at.at("delta_columns_0_20_step1"), rtol, where + " columns");
    expect_fit(stats::estimate_contour(grid, level), at.at("column_fit"), rtol, where + " column fit");
  }
}

void expect_contour(const json& item) {
  const std::string id = item.at("id");
  const auto grid = read_grid(item.at("input").at("grid_rows_mu10_50_cols_delta0_20"));
  const double level = item.at("input").at("level"), rtol = item.at("rtol");
  const auto& expect = item.at("expect");
  const std::vector<double> lines{0, 2.5, 5, 7.5, 10, 12.5, 15, 17.5, 20};
  const auto columns = stats::column_crossings(grid, level, lines);
  expect_points(columns.points, expect.at("columns"), rtol, id);
  if (expect.at("status") == "undefined") {
    EXPECT_FALSE(stats::fit_contour(columns.points)) << id;
  }
}

TEST(Pilot, AgreesWithTheReferenceAnswers) {
  for (const auto& item : oracle::cases("pilot")) {
    SCOPED_TRACE(std::string(item.at("id")));
    if (item.at("op") == "pilot_pipeline") expect_pipeline(item);
    if (item.at("op") == "contour") expect_contour(item);
  }
}

/// Scores 4 + slope (mu - a exp(b delta)) without noise.
std::vector<PilotRating> plane(double a, double b, double slope = 0.1) {
  std::vector<PilotRating> ratings;
  for (const double mu : {10, 20, 30, 40, 50}) {
    for (const double delta : {0, 5, 10, 15, 20}) {
      if (delta < mu)
        ratings.push_back({1, mu, delta, mu, mu, delta, 4 + slope * (mu - a * std::exp(b * delta))});
    }
  }
  return ratings;
}

TEST(Pilot, ReturnsTheCurveThatAnExactSurfaceHas) {
  const stats::PilotTable table(plane(24, 0.02));
  const auto fit = stats::estimate_contour(table.grid(stats::PilotMean::Harmonic), 4);
  ASSERT_TRUE(fit) << fit.reason();
  // The scores are linear in mu, so bilinear interpolation is exact in mu. Over 5 frames/s of delta the curve
  // differs from a straight line by 0.03 frames/s.
  EXPECT_NEAR(fit->a, 24, 0.05);
  EXPECT_NEAR(fit->b, 0.02, 2e-4);
}

TEST(Pilot, FollowsTheRealisedCoordinates) {
  auto ratings = plane(24, 0.02);
  for (auto& r : ratings) {
    r.realised_mu = 0.95 * r.mu;
    r.realised_mu_arithmetic = 1.1 * r.mu;
    r.realised_delta = 0.5 * r.delta;
  }
  const stats::PilotTable table(ratings);
  const auto nominal =
      stats::estimate_contour(stats::PilotTable(plane(24, 0.02)).grid(stats::PilotMean::Harmonic), 4);
  const auto harmonic = stats::estimate_contour(table.grid(stats::PilotMean::Harmonic), 4);
  const auto arithmetic = stats::estimate_contour(table.grid(stats::PilotMean::Arithmetic), 4);
  EXPECT_NEAR(harmonic->a, 0.95 * nominal->a, 1e-9);
  EXPECT_NEAR(arithmetic->a, 1.1 * nominal->a, 1e-9);
  EXPECT_NEAR(harmonic->b, 2 * nominal->b, 1e-9);
}

TEST(Pilot, CountsWhereTheContourLeavesTheGrid) {
  const stats::PilotTable table(plane(31, 0.035));
  const auto grid = table.grid(stats::PilotMean::Harmonic);
  const auto contour = stats::column_crossings(grid, 4, stats::contour_lines(grid));
  // 31 exp(0.035 delta) reaches 50 at delta = 13.66.
  EXPECT_EQ(contour.lines, 21);
  EXPECT_EQ(contour.crossed, 14);
  EXPECT_EQ(contour.above_grid, 7);
  EXPECT_EQ(contour.below_grid, 0);
  const auto inner = stats::fit_contour(contour.points);
  EXPECT_NEAR(inner->a, 31, 0.1);
  EXPECT_NEAR(inner->b, 0.035, 1e-3);
}

TEST(Pilot, SaysWhyThereIsNoContour) {
  auto flat = plane(24, 0.02, 0);
  const stats::PilotTable table(flat);
  EXPECT_TRUE(table.all_equal());
  const auto grid = table.grid(stats::PilotMean::Harmonic);
  EXPECT_EQ(stats::column_crossings(grid, 4, stats::contour_lines(grid)).on_node, 21);
  EXPECT_FALSE(stats::estimate_contour(grid, 4));
  const auto low = stats::column_crossings(grid, 3, stats::contour_lines(grid));
  EXPECT_EQ(low.below_grid, 21);
  EXPECT_FALSE(stats::estimate_contour(ScoreGrid{}, 4));
}

TEST(Pilot, LeavesCellsWithoutRatingsOut) {
  auto ratings = plane(24, 0.02);
  std::erase_if(ratings, [](const PilotRating& r) { return r.mu == 20 && r.delta == 10; });
  const auto grid = stats::PilotTable(ratings).grid(stats::PilotMean::Harmonic);
  const auto contour = stats::column_crossings(grid, 4, stats::contour_lines(grid));
  // The contour is below the row of 30 frames/s until delta = 11.2, so lines 6 to 11 do not cross it.
  for (const auto& point : contour.points) EXPECT_TRUE(point.delta <= 5 || point.delta >= 12) << point.delta;
  EXPECT_EQ(contour.crossed, 15);
}

TEST(Pilot, WeighsParticipantsNotRatings) {
  std::vector<PilotRating> ratings{
      {1, 10, 0, 10, 10, 0, 2}, {1, 10, 0, 10, 10, 0, 4}, {2, 10, 0, 10, 10, 0, 7}, {2, 20, 0, 20, 20, 0, 7}};
  const stats::PilotTable table(ratings);
  EXPECT_EQ(table.participants(), 2);
  EXPECT_EQ(table.incomplete_participants(), 1);
  EXPECT_EQ(table.settings(), 2u);
  EXPECT_DOUBLE_EQ(table.grid(stats::PilotMean::Harmonic).at(0, 0)->score, 5);
  EXPECT_DOUBLE_EQ(table.grid(stats::PilotMean::Harmonic, std::vector<double>{3, 1}).at(0, 0)->score, 4);
  EXPECT_FALSE(table.grid(stats::PilotMean::Harmonic, std::vector<double>{1, 0}).at(1, 0));
}

TEST(Pilot, IntervalsOverParticipantsAreReproducibleAndHoldTheEstimate) {
  const stats::PilotTable table(read_csv("pilot16.csv"));
  const auto one = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, {500, 3, 0.95});
  const auto two = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, {500, 3, 0.95});
  const auto other = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, {500, 4, 0.95});
  ASSERT_TRUE(one.spread) << one.spread.reason();
  EXPECT_EQ(one.spread->a_ci, two.spread->a_ci);
  EXPECT_EQ(one.spread->b_ci, two.spread->b_ci);
  EXPECT_NE(one.spread->a_ci, other.spread->a_ci);
  EXPECT_LT(one.spread->a_ci[0], one.fit->a);
  EXPECT_GT(one.spread->a_ci[1], one.fit->a);
  EXPECT_LT(one.spread->b_ci[0], one.fit->b);
  EXPECT_GT(one.spread->b_ci[1], one.fit->b);
  const auto narrow = stats::estimate_pilot(table, stats::PilotMean::Harmonic, 4, {500, 3, 0.5});
  EXPECT_LT(narrow.spread->a_ci[1] - narrow.spread->a_ci[0], one.spread->a_ci[1] - one.spread->a_ci[0]);
}

TEST(Pilot, IdenticalParticipantsLeaveNoSpread) {
  std::vector<PilotRating> ratings;
  for (int p = 0; p < 6; ++p) {
    for (auto r : plane(24, 0.02)) {
      r.participant = p;
      ratings.push_back(r);
    }
  }
  const auto estimate =
      stats::estimate_pilot(stats::PilotTable(ratings), stats::PilotMean::Harmonic, 4, {100, 1, 0.95});
  ASSERT_TRUE(estimate.spread);
  EXPECT_NEAR(estimate.spread->a_se, 0, 1e-9);
  EXPECT_NEAR(estimate.spread->a_ci[0], estimate.fit->a, 1e-9);
}

TEST(Pilot, RefusesAnIntervalOverTooFewParticipants) {
  const auto estimate =
      stats::estimate_pilot(stats::PilotTable(plane(24, 0.02)), stats::PilotMean::Harmonic, 4, {});
  EXPECT_TRUE(estimate.fit);
  EXPECT_FALSE(estimate.spread);
  EXPECT_NE(estimate.spread.reason().find("not 1"), std::string::npos);
}

TEST(Pilot, RefusesAnIntervalWhenManyResamplesHaveNoContour) {
  // One participant of five causes the contour; without them every score is above the level.
  std::vector<PilotRating> ratings = plane(24, 0.02);
  for (auto& r : ratings) r.score = r.mu < 25 ? -40 : 6;
  for (int p = 2; p < 6; ++p) {
    for (auto r : plane(24, 0.02)) {
      r.participant = p;
      r.score = 6;
      ratings.push_back(r);
    }
  }
  const auto estimate =
      stats::estimate_pilot(stats::PilotTable(ratings), stats::PilotMean::Harmonic, 4, {200, 1, 0.95});
  ASSERT_TRUE(estimate.fit) << estimate.fit.reason();
  EXPECT_FALSE(estimate.spread);
  EXPECT_NE(estimate.spread.reason().find("resamples"), std::string::npos);
}

TEST(Pilot, RefusesNumbersThatAreNone) {
  auto ratings = plane(24, 0.02);
  ratings[3].score = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(stats::PilotTable{ratings}, std::invalid_argument);
}

}  // namespace
