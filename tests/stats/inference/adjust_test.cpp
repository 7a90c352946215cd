#include "stats/inference/adjust.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using stats::adjust;
using stats::Adjustment;
using Values = std::vector<double>;

const std::map<std::string, Adjustment> methods{{"bonferroni", Adjustment::Bonferroni},
                                                {"holm", Adjustment::Holm},
                                                {"BH", Adjustment::BenjaminiHochberg},
                                                {"fdr", Adjustment::BenjaminiHochberg},
                                                {"none", Adjustment::None}};
/// Adjustments in the reference answers that the project does not implement.
const std::set<std::string> absent{"hochberg", "hommel", "BY"};

TEST(Adjust, AgreesWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("adjust")) {
    const auto p = oracle::numbers(c.at("input").at("p"));
    const std::size_t family = c.at("input").value("n", std::size_t{0});
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, adjust(p, Adjustment::Holm, family));
      continue;
    }
    for (const auto& [field, want] : c.at("expect").items()) {
      if (field == "status" || field == "reason" || want.is_null() || absent.contains(field)) continue;
      const std::string id = c.at("id").get<std::string>() + ": " + field;
      ASSERT_TRUE(methods.contains(field)) << id << ": nobody compares it";
      const auto got = adjust(p, methods.at(field), family);
      ASSERT_TRUE(got) << id << ": " << got.reason();
      ASSERT_EQ(got->p.size(), want.size()) << id;
      for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_EQ(std::isnan(got->p[i]), want[i].is_null()) << id;
        oracle::expect_number(id, got->p[i], want[i], c.at("rtol"), 1e-320);
      }
    }
  }
}

/// Holm by closed testing: the largest Bonferroni p of all subsets that contain the hypothesis.
double closed(const Values& p, std::size_t index) {
  double worst = 0;
  for (unsigned subset = 1; subset < 1u << p.size(); ++subset) {
    if (!(subset >> index & 1u)) continue;
    Values members;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (subset >> i & 1u) members.push_back(p[i]);
    const double least = *std::min_element(members.begin(), members.end());
    worst = std::max(worst, std::min(1.0, static_cast<double>(members.size()) * least));
  }
  return worst;
}

TEST(Adjust, HolmIsAClosedTest) {
  uniformity::Draws draws(3);
  for (int round = 0; round < 200; ++round) {
    Values p;
    for (std::size_t i = 0; i < 1 + static_cast<std::size_t>(round) % 8; ++i)
      p.push_back(std::pow(draws.uniform(), 2));
    if (p.size() > 2) p[2] = p[0];  // ties
    const auto holm = adjust(p, Adjustment::Holm);
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(holm->p[i], closed(p, i), 1e-15);
  }
}

TEST(Adjust, OrderOfTheTestsDoesNotMatter) {
  uniformity::Draws draws(4);
  Values p;
  for (int i = 0; i < 30; ++i) p.push_back(std::pow(draws.uniform(), 3));
  Values turned(p.rbegin(), p.rend());
  for (const auto& [name, method] : methods) {
    const auto one = adjust(p, method), other = adjust(turned, method);
    EXPECT_EQ(one->p, Values(other->p.rbegin(), other->p.rend())) << name;
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_GE(one->p[i], p[i]) << name;
  }
}

TEST(Adjust, StrongerMethodsGiveNoLargerP) {
  uniformity::Draws draws(5);
  for (int round = 0; round < 50; ++round) {
    Values p;
    for (int i = 0; i < 10; ++i) p.push_back(std::pow(draws.uniform(), 3));
    const auto of = [&](Adjustment method) { return adjust(p, method)->p; };
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double rounding = 1e-15;
      EXPECT_LE(of(Adjustment::Holm)[i], of(Adjustment::Bonferroni)[i] + rounding);
      EXPECT_LE(of(Adjustment::BenjaminiHochberg)[i], of(Adjustment::Holm)[i] + rounding);
    }
  }
}

TEST(Adjust, ALargerFamilyIsPaddedWithOnes) {
  const Values p{0.029, 0.002};
  for (const auto& [name, method] : methods)
    EXPECT_EQ(adjust(p, method, 5)->p[0], adjust(Values{0.029, 0.002, 1, 1, 1}, method)->p[0]) << name;
  EXPECT_EQ(adjust(p, Adjustment::Holm, 5)->family, 5u);
}

TEST(Adjust, MissingTestsDoNotCount) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto got = adjust(Values{nan, 0.01, nan, 0.03}, Adjustment::Bonferroni);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->missing, 2u);
  EXPECT_EQ(got->family, 2u);
  EXPECT_TRUE(std::isnan(got->p[0]) && std::isnan(got->p[2]));
  EXPECT_EQ(got->p[1], 0.02);
  EXPECT_EQ(got->p[3], 0.06);
}

TEST(Adjust, RefusesWhatIsNoFamily) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(adjust(Values{}, Adjustment::Holm).reason(), "");
  EXPECT_NE(adjust(Values{nan, nan}, Adjustment::Holm).reason(), "");
  EXPECT_NE(adjust(Values{0.5, 1.5}, Adjustment::Holm).reason(), "");
  EXPECT_NE(adjust(Values{-0.1}, Adjustment::Holm).reason(), "");
  EXPECT_NE(adjust(Values{0.1, 0.2, 0.3}, Adjustment::Holm, 2).reason(), "");
}

TEST(Adjust, HolmKeepsTheFamilysLevelUnderTheNull) {
  uniformity::Draws draws(6);
  int families = 0;
  constexpr int rounds = 20'000;
  for (int round = 0; round < rounds; ++round) {
    Values p;
    for (int i = 0; i < 5; ++i) p.push_back(draws.uniform());
    const auto adjusted = adjust(p, Adjustment::Holm)->p;
    families += *std::min_element(adjusted.begin(), adjusted.end()) <= 0.05;
  }
  // Exactly 1 - (1 - 0.01)^5 = 0.049 for independent tests; 5 standard errors.
  EXPECT_NEAR(families / double{rounds}, 0.04901, 5 * std::sqrt(0.049 * 0.951 / rounds));
}

TEST(PaperNumbers, Stars) {
  EXPECT_STREQ(stats::stars(0.05), "");
  EXPECT_STREQ(stats::stars(0.0499), "*");
  EXPECT_STREQ(stats::stars(0.01), "*");
  EXPECT_STREQ(stats::stars(0.0099), "**");
  EXPECT_STREQ(stats::stars(0.001), "**");
  EXPECT_STREQ(stats::stars(0.0009), "***");
  EXPECT_STREQ(stats::stars(0), "***");
  EXPECT_STREQ(stats::stars(std::numeric_limits<double>::quiet_NaN()), "");
}

}  // namespace
