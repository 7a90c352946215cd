/// The Statistical Reference Datasets of NIST in the oracle's nist folder, against their certified values.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "stats/base/json.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/linear_fit.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using json = base::Json;
using Values = std::vector<double>;
constexpr double eight_digits = 1e-8;

/// The certified data sets of a class, such as "univariate".
json certified(const std::string& kind) {
  std::ifstream in(oracle::folder() / "nist" / "certified.json");
  if (!in)
    throw std::runtime_error(
        "cannot read nist/certified.json of the oracle; mend: restore it, or unset VIP_ORACLE_DIR");
  return json::parse(in).at(kind);
}

double number(const json& item) { return std::stod(item.get<std::string>()); }

/// The columns of numbers below the last line that starts with "Data:".
std::vector<Values> columns(const json& data_set) {
  const auto path = oracle::folder() / "nist" / data_set.at("file").get<std::string>();
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  std::vector<Values> out;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("Data:", 0) == 0) out.clear();
    std::istringstream words(line);
    Values row;
    std::string word;
    for (; words >> word;) {
      char* end = nullptr;
      row.push_back(std::strtod(word.c_str(), &end));
      if (*end != '\0') break;
      word.clear();
    }
    if (row.empty() || !word.empty() || (!out.empty() && row.size() != out.size())) continue;
    out.resize(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) out[i].push_back(row[i]);
  }
  return out;
}

void expect_digits(const std::string& what, double got, double want, double rtol, double scale = 1) {
  EXPECT_LE(std::abs(got - want), oracle::bound(want, rtol, scale))
      << what << ": " << got << " instead of " << want;
}

TEST(Nist, Univariate) {
  const auto sets = certified("univariate");
  ASSERT_FALSE(sets.empty()) << "the pack has no univariate NIST data";
  for (const auto& [name, set] : sets.items()) {
    const auto y = columns(set).at(0);
    ASSERT_EQ(y.size(), set.at("n").get<std::size_t>()) << name;
    const auto got = stats::describe(y);
    ASSERT_TRUE(got) << name;
    expect_digits(name + ": mean", got->mean, number(set.at("mean")), eight_digits);
    expect_digits(name + ": sd", *got->sd, number(set.at("sd")), eight_digits);
    expect_digits(name + ": lag 1", *got->autocorrelation, number(set.at("autocorr1")), eight_digits);
  }
}

/// x, x^2 ... x^degree; empty if a power is not an integer that a double holds exactly.
std::vector<Values> powers(const Values& x, std::size_t degree) {
  std::vector<Values> out{x};
  while (out.size() < degree) {
    out.push_back(out.back());
    for (std::size_t i = 0; i < x.size(); ++i) out.back()[i] *= x[i];
  }
  for (const auto& column : out)
    for (const double v : column)
      if (v != std::floor(v) || std::abs(v) > 0x1p53) return {};
  return out;
}

TEST(Nist, Linear) {
  const auto sets = certified("linear");
  ASSERT_FALSE(sets.empty()) << "the pack has no linear NIST data";
  for (const auto& [name, set] : sets.items()) {
    auto data = columns(set);
    ASSERT_GE(data.size(), 2u) << name;
    const auto y = data.front();
    data.erase(data.begin());
    const auto& parameters = set.at("params");
    const bool intercept = parameters.contains("B0");
    // One predictor with more than two coefficients is a polynomial.
    if (intercept && data.size() == 1 && parameters.size() > 2) data = powers(data[0], parameters.size() - 1);
    // Skips polynomials whose powers would be rounded: fit_linear cannot reach their certified digits.
    if (data.empty()) continue;
    const auto got = stats::fit_linear(data, y, intercept);
    ASSERT_TRUE(got) << name << ": " << got.reason();
    ASSERT_EQ(got->coefficients.size(), parameters.size()) << name;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const auto label = "B" + std::to_string(i + (intercept ? 0 : 1));
      const auto& want = parameters.at(label);
      expect_digits(name + ": " + label, got->coefficients[i], number(want.at("est")), eight_digits);
      expect_digits(name + ": error of " + label, got->standard_errors[i], number(want.at("se")),
                    eight_digits);
    }
  }
}

}  // namespace
