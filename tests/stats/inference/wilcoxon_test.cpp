#include "stats/inference/wilcoxon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/stats/inference/sampling.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using namespace stats;
using oracle::expect_field;
using Values = std::vector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

void expect_flag(const base::Json& c, const std::string& field, bool got) {
  if (oracle::asks(c.at("expect"), field)) {
    EXPECT_EQ(got, c.at("expect").at(field).get<bool>()) << c.at("id") << ": " << field;
  }
}

void expect_signed(const base::Json& c, const SignedRank& got) {
  expect_field(c, "n", static_cast<double>(got.n));
  expect_field(c, "n_nonzero", static_cast<double>(got.n_nonzero));
  expect_field(c, "W_plus", got.w_plus);
  expect_field(c, "W_minus", got.w_minus);
  expect_flag(c, "has_ties", got.has_ties);
  expect_field(c, "rank_biserial", got.rank_biserial);
  expect_field(c, "p_exact_conditional_two", got.p_exact);
  expect_field(c, "p_exact_less", got.p_exact_less);
  expect_field(c, "p_exact_greater", got.p_exact_greater);
  expect_field(c, "p_normal_cc", got.p_normal);
  expect_field(c, "p_normal_nocc", got.p_normal_uncorrected);
  // R's wilcox.test is exact below 50 values without ties and zeros; otherwise it uses the normal
  // distribution.
  const bool plain = got.n < 50 && !got.has_ties && got.n_nonzero == got.n;
  expect_field(c, "R_default_p", plain ? got.p() : got.p_normal);
  expect_field(c, "hodges_lehmann", got.hodges_lehmann);
  expect_field(c, "walsh_median_all", got.hodges_lehmann);
  expect_field(c, "pratt_W_plus", got.pratt_w_plus);
  expect_field(c, "pratt_z_nocc", got.pratt_z);
  expect_field(c, "pratt_p_normal_nocc", got.pratt_p_normal);
  expect_field(c, "pratt_p_exact", got.pratt_p_exact);
  oracle::expect_known_fields(c, {"n",
                                  "n_nonzero",
                                  "W_plus",
                                  "W_minus",
                                  "has_ties",
                                  "rank_biserial",
                                  "p_exact_conditional_two",
                                  "p_exact_less",
                                  "p_exact_greater",
                                  "p_normal_cc",
                                  "p_normal_nocc",
                                  "R_default_p",
                                  "R_default_method",
                                  "hodges_lehmann",
                                  "hl_ci95_exact",
                                  "walsh_median_all",
                                  "pratt_W_plus",
                                  "pratt_z_nocc",
                                  "pratt_p_normal_nocc",
                                  "pratt_p_exact"});
  const auto& expect = c.at("expect");
  if (oracle::asks(expect, "R_default_method")) {
    const bool exact = expect.at("R_default_method").get<std::string>().find("exact") != std::string::npos;
    EXPECT_EQ(plain, exact) << c.at("id");
  }
  if (oracle::asks(expect, "hl_ci95_exact")) {
    ASSERT_TRUE(got.hodges_lehmann_ci) << c.at("id");
    for (std::size_t i = 0; i < 2; ++i) {
      oracle::expect_number(c.at("id").get<std::string>() + ": hl_ci95_exact", (*got.hodges_lehmann_ci)[i],
                            expect.at("hl_ci95_exact").at(i), c.at("rtol").get<double>());
    }
  }
}

TEST(Wilcoxon, Oracle) {
  for (const auto& c : oracle::cases("wilcoxon")) {
    const auto op = c.at("op").get<std::string>();
    if (op == "mannwhitney") continue;  // the project has no rank test of two groups
    ASSERT_EQ(op, "wilcoxon.signed") << c.at("id");
    const auto got = signed_rank(oracle::numbers(c.at("input").at("d")));
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
    } else {
      ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
      expect_signed(c, *got);
    }
  }
}

/// Tail probabilities by enumerating all 2^n signs.
std::array<double, 2> enumerated(const Values& d) {
  const auto n = d.size();
  const auto own = signed_rank(d);
  double lower = 0, upper = 0;
  for (std::size_t signs = 0; signs < (std::size_t{1} << n); ++signs) {
    Values flipped;
    for (std::size_t i = 0; i < n; ++i)
      flipped.push_back((signs >> i & 1) ? std::abs(d[i]) : -std::abs(d[i]));
    const auto other = signed_rank(flipped);
    lower += other->w_plus <= own->w_plus;
    upper += other->w_plus >= own->w_plus;
  }
  const double all = std::ldexp(1.0, static_cast<int>(n));
  return {lower / all, upper / all};
}

TEST(SignedRank, ExactMeansAllSigns) {
  for (const Values& d : {Values{1.5, -2, 3, 0.5, -0.25, 4}, Values{1, 1, -1, 2, 2, -3, 3}, Values{5}}) {
    const auto got = signed_rank(d);
    ASSERT_TRUE(got);
    const auto tails = enumerated(d);
    EXPECT_DOUBLE_EQ(*got->p_exact_less, tails[0]);
    EXPECT_DOUBLE_EQ(*got->p_exact_greater, tails[1]);
  }
}

TEST(SignedRank, SmallAndEmptySamples) {
  EXPECT_EQ(signed_rank(Values{}).reason(), "no values");
  EXPECT_EQ(signed_rank(Values{unknown}).reason(), "no values");
  EXPECT_EQ(signed_rank(Values{0, 0, 0}).reason(), "no difference that is not zero");
  EXPECT_EQ(signed_rank(Values{1, infinite}).reason(), "a value is infinite");
  EXPECT_EQ(signed_rank(Values(8000, 1.0)).reason(), "more pairs of values than 2.5e7");
  EXPECT_THROW(signed_rank(Values{1}, 1), std::invalid_argument);
  const auto one = signed_rank(Values{-2, unknown});
  ASSERT_TRUE(one);
  EXPECT_EQ(*one->p_exact, 1);
  EXPECT_EQ(one->n_missing, 1u);
  EXPECT_EQ(one->hodges_lehmann, -2);
}

TEST(SignedRank, OrderScaleAndSwap) {
  const Values d{0.3, -1.2, 2.5, 0.7, -0.1, 1.9, 3.3, 0.3};
  const auto base = signed_rank(d);
  Values moved(d.rbegin(), d.rend()), turned;
  for (auto& v : moved) v *= 0x1p-500;
  for (const double v : d) turned.push_back(-v);
  const auto scaled = signed_rank(moved), swapped = signed_rank(turned);
  ASSERT_TRUE(base && scaled && swapped);
  EXPECT_EQ(*scaled->p_exact, *base->p_exact);
  EXPECT_EQ(scaled->p_normal, base->p_normal);
  EXPECT_EQ(scaled->hodges_lehmann, base->hodges_lehmann * 0x1p-500);
  EXPECT_EQ(*swapped->p_exact_less, *base->p_exact_greater);
  EXPECT_EQ(swapped->w_plus, base->w_minus);
  EXPECT_EQ(swapped->hodges_lehmann, -base->hodges_lehmann);
}

TEST(SignedRank, IntervalHoldsTheMedianAsOftenAsItSays) {
  constexpr int sets = 3000;
  std::mt19937_64 random(8);
  int covered = 0;
  for (int i = 0; i < sets; ++i) {
    const auto got = signed_rank(sampling::normal(random, 15, 2));
    covered += (*got->hodges_lehmann_ci)[0] <= 2 && 2 <= (*got->hodges_lehmann_ci)[1];
  }
  EXPECT_NEAR(covered / static_cast<double>(sets), 0.952, 0.015) << "2 P(W <= 25) = 0.0479 at n = 15";
}

/// P(W <= w) by enumerating all signs of the ranks 1 to n.
double lower_tail(int n, int w) {
  int as_low = 0;
  for (int signs = 0; signs < 1 << n; ++signs) {
    int sum = 0;
    for (int rank = 1; rank <= n; ++rank) sum += signs >> (rank - 1) & 1 ? rank : 0;
    as_low += sum <= w ? 1 : 0;
  }
  return std::ldexp(as_low, -n);
}

TEST(SignedRank, TheIntervalSaysItsExactLevel) {
  std::mt19937_64 random(3);
  for (int n = 2; n <= 14; ++n) {
    const auto got = signed_rank(sampling::normal(random, static_cast<std::size_t>(n), 0));
    // The narrowest interval that reaches the level, or else the widest there is.
    int cut = 0;
    while (1 - 2 * lower_tail(n, cut + 1) >= 0.95) ++cut;
    EXPECT_NEAR(got->hodges_lehmann_level, 1 - 2 * lower_tail(n, cut), 1e-15) << n;
    EXPECT_EQ(got->hodges_lehmann_level >= 0.95, n >= 6) << n;
  }
  EXPECT_EQ(signed_rank(Values{1, 2, 4, 7, 11})->hodges_lehmann_level, 0.9375);
}

// With 5 values the interval is their whole range, which holds the centre less often than 95 %.
TEST(SignedRank, FewValuesHoldTheCentreAsOftenAsTheirLevelSays) {
  constexpr int sets = 4000;
  std::mt19937_64 random(11);
  int covered = 0;
  double level = 0;
  for (int i = 0; i < sets; ++i) {
    const auto got = signed_rank(sampling::normal(random, 5, 2));
    covered += (*got->hodges_lehmann_ci)[0] <= 2 && 2 <= (*got->hodges_lehmann_ci)[1];
    level = got->hodges_lehmann_level;
  }
  EXPECT_NEAR(covered / static_cast<double>(sets), level, 3 * std::sqrt(level * (1 - level) / sets));
}

/// p-value of a discrete statistic, spread randomly over its step (Lewis 1973): uniform under the null.
double spread(double at_least, double at_most, std::mt19937_64& random) {
  const double step = at_least + at_most - 1;
  return at_most - step * std::uniform_real_distribution<double>()(random);
}

TEST(SignedRank, PValuesAreUniformUnderTheNull) {
  constexpr std::size_t sets = 4000;
  std::mt19937_64 random(21);
  for (const bool rounded : {false, true}) {
    std::vector<double> p;
    for (std::size_t i = 0; i < sets; ++i) {
      auto d = sampling::normal(random, 20, 0, 2);
      if (rounded) {
        for (auto& v : d) v = std::round(v);
      }
      const auto got = signed_rank(d);
      p.push_back(spread(*got->p_exact_greater, *got->p_exact_less, random));
    }
    EXPECT_LT(sampling::uniform_distance(p), sampling::critical_distance(sets)) << rounded;
  }
}

TEST(SignedRank, LargeSamplesTurnToTheNormal) {
  std::mt19937_64 random(4);
  const auto d = sampling::normal(random, 800, 0.05);
  const auto got = signed_rank(d);
  ASSERT_TRUE(got && got->p_exact);
  EXPECT_NEAR(*got->p_exact, got->p_normal, 1e-3);
  EXPECT_FALSE(signed_rank(sampling::normal(random, 1001))->p_exact);
}

}  // namespace
