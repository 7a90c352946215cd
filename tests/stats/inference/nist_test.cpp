/// The Statistical Reference Datasets of NIST in the oracle's nist folder, against their certified values.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "stats/base/json.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/linear_fit.hpp"
#include "stats/inference/nonlinear_fit.hpp"
#include "tests/stats/inference/formula.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using json = base::Json;
using Values = std::vector<double>;
constexpr double eight_digits = 1e-8, six_digits = 1e-6;

/// Certified data sets of one class.
json certified(const std::string& kind) {
  std::ifstream in(oracle::folder() / "nist" / "certified.json");
  if (!in) throw std::runtime_error("cannot read certified.json of NIST");
  return json::parse(in).at(kind);
}

double number(const json& item) { return std::stod(item.get<std::string>()); }

Values numbers(const json& list) {
  Values out;
  for (const auto& item : list) out.push_back(number(item));
  return out;
}

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

TEST(Nist, Anova) {
  const auto sets = certified("anova");
  ASSERT_FALSE(sets.empty()) << "the pack has no ANOVA data of NIST";
  for (const auto& [name, set] : sets.items()) {
    const auto data = columns(set);
    ASSERT_EQ(data.size(), 2u) << name;
    std::map<double, Values> by_level;
    double largest = 0;
    for (std::size_t i = 0; i < data[0].size(); ++i) {
      by_level[data[0][i]].push_back(data[1][i]);
      largest = std::max(largest, std::abs(data[1][i]));
    }
    std::vector<Values> groups;
    for (const auto& [level, values] : by_level) groups.push_back(values);
    const auto got = stats::anova_one_way(groups);
    ASSERT_TRUE(got) << name << ": " << got.reason();
    ASSERT_EQ(got->n, set.at("n").get<std::size_t>()) << name;
    // The data have more digits than a double at 1e12: no program that reads doubles can know them.
    const double spread = std::sqrt(number(set.at("ms_within")));
    const double rtol = std::max(eight_digits, 4 * std::numeric_limits<double>::epsilon() * largest / spread);
    expect_digits(name + ": df between", got->df_between, number(set.at("df_between")), 0);
    expect_digits(name + ": df within", got->df_within, number(set.at("df_within")), 0);
    expect_digits(name + ": between", got->ss_between, number(set.at("ss_between")), rtol);
    expect_digits(name + ": within", got->ss_within, number(set.at("ss_within")), rtol);
    expect_digits(name + ": F", got->f, number(set.at("F")), rtol);
  }
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
    // One predictor with more coefficients than a line has is a polynomial.
    const bool polynomial = intercept && data.size() == 1 && parameters.size() > 2;
    const auto got = polynomial ? stats::fit_polynomial(data[0], y, parameters.size() - 1)
                                : stats::fit_linear(data, y, intercept);
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

/// A data set of NIST with its model.
class NistModel {
 public:
  explicit NistModel(const json& set) : n_parameters_(set.at("certified").size()) {
    auto data = columns(set);
    y_ = data.at(0);
    data.erase(data.begin());
    auto text = set.at("model").get<std::string>();
    if (const auto equals = text.find('='); equals != std::string::npos) {
      if (text.find("log") < equals) {
        for (auto& v : y_) v = std::log(v);
      }
      text = text.substr(equals + 1);
    }
    node_ = formula::Parser(text).parse();
    for (std::size_t i = 0; i < y_.size(); ++i) {
      predictors_.emplace_back();
      for (const auto& column : data) predictors_.back().push_back(column[i]);
    }
  }

  stats::NonlinearModel model() const {
    stats::NonlinearModel out{n_parameters_, y_.size(), {}, {}};
    out.residuals = [this](std::span<const double> b, std::span<double> r) {
      for (std::size_t i = 0; i < y_.size(); ++i) r[i] = at(b, i).value - y_[i];
    };
    out.jacobian = [this](std::span<const double> b, std::span<double> jacobian) {
      for (std::size_t i = 0; i < y_.size(); ++i) {
        const auto here = at(b, i);
        std::copy_n(here.slope.begin(), n_parameters_,
                    jacobian.begin() + static_cast<std::ptrdiff_t>(i * n_parameters_));
      }
    };
    return out;
  }

  /// Sums of squares below this are rounding of the data.
  double rounding() const {
    double squares = 0;
    for (const double v : y_) squares += v * v;
    return 1e-20 * squares;
  }

 private:
  formula::Dual at(std::span<const double> b, std::size_t i) const {
    return node_({{b.begin(), b.end()}, predictors_[i]});
  }

  std::size_t n_parameters_;
  Values y_;
  std::vector<Values> predictors_;
  formula::Node node_;
};

TEST(Nist, NonlinearFromBothStarts) {
  const auto sets = certified("nonlinear");
  ASSERT_FALSE(sets.empty()) << "the pack has no nonlinear NIST data";
  for (const auto& [name, set] : sets.items()) {
    const NistModel data(set);
    const auto want = numbers(set.at("certified")), errors = numbers(set.at("se"));
    const double rss = number(set.at("rss"));
    for (const char* start : {"start1", "start2"}) {
      const auto got = stats::fit_nonlinear(data.model(), numbers(set.at(start)));
      const auto where = name + " from " + start;
      if (!got) {
        ADD_FAILURE() << where << ": " << got.reason();
        continue;
      }
      for (std::size_t i = 0; i < want.size(); ++i) {
        const auto label = where + ": b" + std::to_string(i + 1);
        expect_digits(label, got->parameters[i], want[i], six_digits);
        if (rss > data.rounding())
          expect_digits(label + "'s error", got->standard_errors[i], errors[i], six_digits);
      }
      if (rss > data.rounding()) expect_digits(where + ": rss", got->rss, rss, six_digits);
    }
  }
}

}  // namespace
