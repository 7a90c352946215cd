#include "stats/inference/binomial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/inference/adjust.hpp"
#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using oracle::number;
using stats::Alternative;
using stats::binomial_test;

/// Scale of p-values for the comparison with reference answers. It is so small that only errors relative to p
/// count.
constexpr double p_scale = 1e-290;

Alternative side(const std::string& name) {
  if (name == "less") return Alternative::Less;
  if (name == "greater") return Alternative::Greater;
  return Alternative::TwoSided;
}

/// The interval of a method, which is named as in the reference answers.
const std::array<double, 2>* interval(const stats::BinomialTest& test, const std::string& method) {
  if (method == "clopper_pearson") return &test.clopper_pearson;
  if (method == "wilson") return &test.wilson;
  if (method == "wilson_cc") return &test.wilson_cc;
  if (method == "jeffreys") return &test.jeffreys;
  if (method == "agresti_coull") return &test.agresti_coull;
  return nullptr;
}

const std::set<std::string> simple_fields{"status",  "p",       "midp_two_sided", "estimate",
                                          "cohen_g", "cohen_h", "reason"};

void expect_interval(const json& c, const std::string& field) {
  const auto& input = c.at("input");
  const double confidence = std::stod(field.substr(2, 2)) / 100;
  const auto test = binomial_test(number(input.at("k")), number(input.at("n")), number(input.at("p0")),
                                  side(input.at("alternative")), confidence);
  ASSERT_TRUE(test) << c.at("id") << ": " << test.reason();
  const auto* got = interval(*test, field.substr(5));
  ASSERT_NE(got, nullptr) << c.at("id") << ": nobody compares " << field;
  const auto& want = c.at("expect").at(field);
  for (std::size_t end = 0; end < 2; ++end)
    oracle::expect_number(c.at("id").get<std::string>() + ": " + field, (*got)[end], want.at(end),
                          c.at("rtol"));
}

TEST(Binomial, AgreesWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("binomial")) {
    const auto& input = c.at("input");
    const auto test = binomial_test(number(input.at("k")), number(input.at("n")), number(input.at("p0")),
                                    side(input.at("alternative")));
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, test);
      continue;
    }
    ASSERT_TRUE(test) << c.at("id") << ": " << test.reason();
    oracle::expect_field(c, "p", test->p, p_scale);
    oracle::expect_field(c, "midp_two_sided", test->p_mid, p_scale);
    oracle::expect_field(c, "estimate", test->estimate);
    oracle::expect_field(c, "cohen_g", test->cohen_g);
    oracle::expect_field(c, "cohen_h", test->cohen_h);
    for (const auto& [field, want] : c.at("expect").items()) {
      if (want.is_null()) continue;
      if (field.starts_with("ci"))
        expect_interval(c, field);
      else
        EXPECT_TRUE(simple_fields.contains(field)) << c.at("id") << ": nobody compares " << field;
    }
  }
}

/// Choose(n, k) p^k q^(n-k), computed directly.
double mass(int k, int n, double p) {
  double out = 1;
  for (int i = 0; i < k; ++i) out *= p * (n - i) / (i + 1);
  return out * std::pow(1 - p, n - k);
}

TEST(Binomial, EqualsTheSumOverAllCounts) {
  for (const int n : {1, 2, 3, 7, 26, 40}) {
    for (const double p0 : {0.5, 0.3, 0.9}) {
      for (int k = 0; k <= n; ++k) {
        double below = 0, above = 0, both = 0;
        for (int j = 0; j <= n; ++j) {
          if (j <= k) below += mass(j, n, p0);
          if (j >= k) above += mass(j, n, p0);
          if (mass(j, n, p0) <= mass(k, n, p0) * (1 + 1e-7)) both += mass(j, n, p0);
        }
        const std::string where = std::to_string(k) + " of " + std::to_string(n);
        EXPECT_NEAR(binomial_test(k, n, p0, Alternative::Less)->p / below, 1, 1e-12) << where;
        EXPECT_NEAR(binomial_test(k, n, p0, Alternative::Greater)->p / above, 1, 1e-12) << where;
        EXPECT_NEAR(binomial_test(k, n, p0)->p / both, 1, 1e-12) << where;
        EXPECT_NEAR(binomial_test(k, n, p0)->p_mid,
                    std::min(1.0, 2 * std::min(below, above) - mass(k, n, p0)), 1e-12)
            << where;
      }
    }
  }
}

TEST(Binomial, TheEndsHaveClosedForms) {
  for (const int n : {1, 2, 26, 231, 10'000}) {
    const auto none = binomial_test(0, n), every = binomial_test(n, n);
    const double limit = -std::expm1(std::log(0.025) / n);  // 1 - 0.025^(1/n)
    EXPECT_EQ(none->clopper_pearson[0], 0);
    EXPECT_NEAR(none->clopper_pearson[1] / limit, 1, 1e-12) << n;
    EXPECT_NEAR(every->clopper_pearson[0], 1 - limit, 1e-14) << n;
    EXPECT_EQ(every->clopper_pearson[1], 1);
    EXPECT_EQ(none->wilson[0], 0);
    EXPECT_EQ(every->wilson[1], 1);
    EXPECT_EQ(none->jeffreys[0], 0);
    EXPECT_EQ(every->jeffreys[1], 1);
    EXPECT_GT(none->p, 0) << "not impossible, however large n is";
    EXPECT_EQ(none->p, every->p);
  }
  EXPECT_EQ(binomial_test(0, 5, 0)->p, 1) << "what must happen";
  EXPECT_EQ(binomial_test(1, 5, 0)->p, 0) << "what cannot happen";
  EXPECT_EQ(binomial_test(5, 5, 1, Alternative::Less)->p, 1);
  EXPECT_EQ(binomial_test(4, 5, 1)->p, 0);
}

TEST(Binomial, ClopperPearsonIsTheInversionOfTheTest) {
  // For every k, also where gsl_cdf_beta_Pinv gives NaN (from n = 231).
  for (const int n : {26, 231, 500}) {
    for (int k = 1; k < n; ++k) {
      const auto ci = binomial_test(k, n)->clopper_pearson;
      EXPECT_NEAR(binomial_test(k, n, ci[0], Alternative::Greater)->p, 0.025, 1e-11) << k << " of " << n;
      EXPECT_NEAR(binomial_test(k, n, ci[1], Alternative::Less)->p, 0.025, 1e-11) << k << " of " << n;
    }
  }
}

TEST(Binomial, SuccessAndFailureMaySwap) {
  for (const int n : {1, 5, 26, 100}) {
    for (int k = 0; k <= n; ++k) {
      const auto one = binomial_test(k, n, 0.25), other = binomial_test(n - k, n, 0.75);
      EXPECT_NEAR(one->p / other->p, 1, 1e-12);
      EXPECT_NEAR(one->p_mid / other->p_mid, 1, 1e-12);
      EXPECT_NEAR(one->cohen_h, -other->cohen_h, 1e-14);
      for (const auto part : {&stats::BinomialTest::clopper_pearson, &stats::BinomialTest::wilson,
                              &stats::BinomialTest::wilson_cc, &stats::BinomialTest::jeffreys,
                              &stats::BinomialTest::agresti_coull}) {
        EXPECT_NEAR(((*one).*part)[0], 1 - ((*other).*part)[1], 1e-13) << k << " of " << n;
        EXPECT_NEAR(((*one).*part)[1], 1 - ((*other).*part)[0], 1e-13) << k << " of " << n;
      }
    }
  }
}

TEST(Binomial, NeverRejectsATrueNullTooOften) {
  // Exact without simulation: the distribution of p under the null is known.
  for (const int n : {1, 2, 10, 26, 60}) {
    for (const double p0 : {0.5, 0.2}) {
      for (const double alpha : {0.01, 0.05, 0.2}) {
        double level = 0;
        for (int k = 0; k <= n; ++k) level += binomial_test(k, n, p0)->p <= alpha ? mass(k, n, p0) : 0;
        EXPECT_LE(level, alpha) << n << ' ' << p0;
      }
    }
  }
}

TEST(Binomial, PIsUniformOnceItsStepsAreFilledWithDraws) {
  // P(X > k) + U P(X = k), with U uniform on (0, 1), is exactly uniform. A wrong tail or mass would spoil
  // that.
  uniformity::Draws draws(11);
  std::vector<double> values;
  for (int i = 0; i < 4000; ++i) {
    int k = 0;
    for (int trial = 0; trial < 26; ++trial) k += draws.coin(0.35);
    const double at_least = binomial_test(k, 26, 0.35, Alternative::Greater)->p;
    const double mid = binomial_test(k, 26, 0.35, Alternative::Greater)->p_mid;
    values.push_back(at_least - draws.uniform() * 2 * (at_least - mid));
  }
  EXPECT_LT(uniformity::distance(values), uniformity::critical);
}

TEST(Binomial, RefusesWhatIsNoCount) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [k, n] : std::vector<std::pair<double, double>>{
           {0, 0}, {-1, 5}, {6, 5}, {1, -1}, {2.5, 5}, {2, 5.5}, {nan, 5}, {1, nan}, {1, 2e9}})
    EXPECT_NE(binomial_test(k, n).reason(), "") << k << " of " << n;
  for (const double p0 : {-0.1, 1.1, nan}) EXPECT_NE(binomial_test(1, 5, p0).reason(), "");
  for (const double confidence : {0.0, 1.0, nan})
    EXPECT_THROW(binomial_test(1, 5, 0.5, Alternative::TwoSided, confidence), std::invalid_argument);
  EXPECT_THROW(stats::binomial_p(6, 5), std::invalid_argument);
}

TEST(Binomial, HoldsForAMillionTrialsAndMore) {
  // Normal approximation with continuity correction, accurate to 1e-4 here.
  const double n = 1e8, k = n / 2 + 9'000, z = (9'000 - 0.5) / std::sqrt(n / 4);
  EXPECT_NEAR(binomial_test(k, n)->p / std::erfc(z / std::sqrt(2.0)), 1, 1e-4);
  const auto ci = binomial_test(k, n)->clopper_pearson;
  EXPECT_NEAR(binomial_test(k, n, ci[0], Alternative::Greater)->p, 0.025, 1e-9);
}

// The paper's verdicts on Task 2 (section 5.5): p = 0.029 and p = 0.002 with 26 participants.
TEST(PaperNumbers, PreferencesOverFovFluid) {
  std::vector<int> rounds_to_029, rounds_to_002;
  for (int k = 13; k <= 26; ++k) {
    const double p = binomial_test(k, 26)->p;
    if (std::round(p * 1000) == 29) rounds_to_029.push_back(k);
    if (std::round(p * 1000) == 2) rounds_to_002.push_back(k);
  }
  EXPECT_EQ(rounds_to_029, std::vector<int>{19});
  EXPECT_EQ(rounds_to_002, std::vector<int>{21});
  EXPECT_STREQ(stats::stars(binomial_test(19, 26)->p), "*");
  EXPECT_STREQ(stats::stars(binomial_test(21, 26)->p), "**");
  EXPECT_GT(binomial_test(21, 26)->estimate, 0.80) << "\"over 80% of users\" is true of Ours-TSp";
  EXPECT_LT(binomial_test(19, 26)->estimate, 0.80) << "and not of Ours";
  EXPECT_NEAR(binomial_test(18, 26)->p, 0.076, 0.0005) << "one answer less would not have been significant";
}

TEST(PaperNumbers, WhatHolmMakesOfThem) {
  const std::vector<double> p{binomial_test(19, 26)->p, binomial_test(21, 26)->p};
  const auto over = [&](std::size_t family) { return stats::adjust(p, stats::Adjustment::Holm, family)->p; };
  EXPECT_NEAR(over(2)[0], 0.029, 0.0005);
  EXPECT_NEAR(over(2)[1], 0.005, 0.0005);
  EXPECT_NEAR(over(5)[0], 0.116, 0.0005);
  EXPECT_NEAR(over(5)[1], 0.012, 0.0005);
  EXPECT_NEAR(over(10)[0], 0.261, 0.0005);
  EXPECT_NEAR(over(10)[1], 0.025, 0.0005);
}

}  // namespace
