#include "libsim/measure/growth_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;

/// Times factor n^exponent for n particles, each multiplied by one of `shares`.
std::vector<measure::GrowthRow> rows_of(double factor, double exponent, const std::vector<double>& shares) {
  std::vector<measure::GrowthRow> out;
  double particles = 1000;
  for (const double share : shares) {
    measure::GrowthRow row{.n_star = "1k", .particles = particles};
    row.ms_substep_mean = factor * std::pow(particles, exponent) * share;
    row.ms_substep_p99 = 1.5 * row.ms_substep_mean;
    out.push_back(row);
    particles *= 4;
  }
  return out;
}

TEST(Growth, APowerLawGivesItsExponent) {
  const measure::Growth exact = measure::growth_of(rows_of(2e-4, 1.25, {1, 1, 1, 1}));
  EXPECT_NEAR(exact.exponent, 1.25, 1e-12);
  EXPECT_NEAR(exact.factor, 2e-4, 1e-12);
  EXPECT_NEAR(exact.standard_error, 0, 1e-12);
}

// Closed form of the slope of a line over x = -1, 0, 1 and of its standard error with one degree of freedom.
TEST(Growth, TheErrorIsThatOfASlope) {
  const std::vector<double> shares{1.1, 0.9, 1.3};
  const measure::Growth growth = measure::growth_of(rows_of(1, 1, shares));
  const double step = std::log(4.0), a = std::log(1.1), b = std::log(0.9), c = std::log(1.3);
  const double slope = (c - a) / 2, mean = (a + b + c) / 3;
  const double rss = std::pow(a - mean + slope, 2) + std::pow(b - mean, 2) + std::pow(c - mean - slope, 2);
  EXPECT_NEAR(growth.exponent, 1 + slope / step, 1e-12);
  EXPECT_NEAR(growth.standard_error, std::sqrt(rss / 2) / step, 1e-12);
}

TEST(Growth, TwoSizesHaveNoErrorAndOneHasNoExponent) {
  const auto rows = rows_of(1, 0.5, {1, 1});
  EXPECT_TRUE(std::isnan(measure::growth_of(rows).standard_error));
  EXPECT_THAT(measure::in_words(measure::growth_of(rows), 2),
              HasSubstr("0.500, standard error -, over 2 sizes"));
  EXPECT_THROW(measure::growth_of({rows[0]}), base::Error);
  EXPECT_THROW(measure::growth_of({rows[0], rows[0]}), base::Error);
}

TEST(Growth, ThePictureHasAPointForEachSize) {
  const auto rows = rows_of(1e-3, 1, {1, 1, 1});
  const std::string svg = measure::to_svg({"Pond", "Ours", "cpu", 5}, rows, measure::growth_of(rows));
  std::size_t points = 0;
  for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++points;
  EXPECT_EQ(points, 3u);
  for (const char* words : {"Pond, Ours on cpu", "exponent 1.000", ">1000<", ">20000<", ">50<"})
    EXPECT_THAT(svg, HasSubstr(words));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

class GrowthE2e : public test::TableTest {};

TEST_F(GrowthE2e, HoldsARowForEachSize) {
  const auto ended =
      table("growth data/scenes/peers_dam.toml --n-star 64,128,256 --frames 3 --warm-up 1 --csv " +
            path("g.csv") + " --svg " + path("g.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("g.csv");
  ASSERT_EQ(table.size(), 3u);
  double particles = 512;
  for (const auto& row : table) {
    EXPECT_EQ(std::stod(row.at("particles_mean")), particles) << "HiRes has eight times n_*";
    EXPECT_GE(std::stod(row.at("substeps_mean")), 1);
    EXPECT_NEAR(std::stod(row.at("ms_substep_mean")) * std::stod(row.at("substeps_mean")),
                std::stod(row.at("ms_frame_mean")), 0.02 * std::stod(row.at("ms_frame_mean")) + 1e-3);
    EXPECT_GT(std::stod(row.at("ms_substep_p99")), 0);
    EXPECT_GT(std::stod(row.at("column_bytes_per_particle")), 32) << "place and velocity alone";
    EXPECT_EQ(row.at("device_bytes_per_particle"), "-") << "no device";
    EXPECT_EQ(row.at("exponent"), table.front().at("exponent"));
    particles *= 2;
  }
  EXPECT_THAT(ended.out, HasSubstr("ms a substep over particles: exponent "));
  EXPECT_THAT(base::read_file(path("g.svg"), 1 << 20), HasSubstr("<circle"));
}

TEST_F(GrowthE2e, RefusesBeforeTheWork) {
  for (const std::string wrong :
       {"--n-star 64", "--n-star 64,64", "--n-star 64,3", "--method Best --n-star 64,128", "nowhere.toml"}) {
    const auto ended = table("growth " + wrong);
    EXPECT_EQ(ended.exit_code, 1) << wrong << ended.out;
    EXPECT_THAT(ended.out, HasSubstr("error")) << wrong;
  }
  EXPECT_THAT(table("growth --n-star 64,64").out, HasSubstr("--n-star 64,64"));
}

}  // namespace
}  // namespace apps
