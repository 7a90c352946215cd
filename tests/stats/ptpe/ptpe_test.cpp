#include "stats/ptpe/ptpe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/file.hpp"

namespace {

/// Rows of the paper's Table 2 as text.
std::vector<std::vector<std::string>> table2() {
  std::istringstream in(base::read_file(base::resource("data/paper/table2_performance.csv"), 1 << 20));
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

TEST(PtpeTolerance, ReproducesTable2OfThePaper) {
  const auto rows = table2();
  ASSERT_EQ(rows.size(), 29u);
  for (const auto& row : rows) {
    const double mean = 1000 / std::stod(row.at(5));
    const double tau = stats::ptpe_tolerance({}, mean, std::stod(row.at(6)));
    // The table prints two decimals of tau.
    EXPECT_LE(std::abs(tau - std::stod(row.at(7))), 0.005 + 1e-9)
        << row.at(0) << '@' << row.at(1) << "k " << row.at(2);
  }
}

TEST(ActivationFloor, HasThePapersExamples) {
  EXPECT_NEAR(stats::activation_floor({}, -1), 0.96, 0.005);
  EXPECT_NEAR(stats::activation_floor({}, -10), 0.67, 0.005);
}

TEST(ActivationFloor, IsOneForACurveThatFalls) { EXPECT_EQ(stats::activation_floor({23.68, -0.02}, -30), 1); }

TEST(PtpeTolerance, GoesByTheMeanOfTheModel) {
  const stats::FpsMoments shown{30, 20, 24, 5};
  EXPECT_NEAR(stats::ptpe_tolerance({10, 0.02, stats::FpsMean::Arithmetic}, shown) -
                  stats::ptpe_tolerance({10, 0.02}, shown),
              4, 1e-12);
}

TEST(ActivationFloor, IsOneWhereNothingIsWrong) {
  EXPECT_EQ(stats::activation_floor({}, 0), 1);
  EXPECT_EQ(stats::activation_floor({}, 30), 1);
}

}  // namespace
