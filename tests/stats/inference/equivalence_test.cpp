#include "stats/inference/equivalence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "stats/inference/t_test.hpp"
#include "tests/stats/inference/sampling.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using namespace stats;
using oracle::expect_field;
using Values = std::vector<double>;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

void expect_case(const base::Json& c, const Result<EquivalenceTest>& got) {
  if (oracle::is_undefined(c)) {
    oracle::expect_refused(c, got);
    return;
  }
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  expect_field(c, "df", got->df);
  expect_field(c, "t_lower", got->t_lower);
  expect_field(c, "p_lower", got->p_lower);
  expect_field(c, "t_upper", got->t_upper);
  expect_field(c, "p_upper", got->p_upper);
  expect_field(c, "p_tost", got->p);
  oracle::expect_known_fields(c, {"df", "t_lower", "p_lower", "t_upper", "p_upper", "p_tost", "ci90"});
  if (!oracle::asks(c.at("expect"), "ci90")) return;
  for (std::size_t i = 0; i < 2; ++i) {
    oracle::expect_number(c.at("id").get<std::string>() + ": ci90", got->ci[i],
                          c.at("expect").at("ci90").at(i), c.at("rtol").get<double>(), got->stderr_estimate);
  }
}

TEST(EquivalenceTest, Oracle) {
  for (const auto& c : oracle::cases("tost")) {
    const auto op = c.at("op").get<std::string>();
    // The reference answers have further tests, but the project has only the paired one.
    if (op == "tost.one" || op == "tost.indep" || op == "tost.welch") continue;
    ASSERT_EQ(op, "tost.paired") << c.at("id");
    const auto& input = c.at("input");
    expect_case(c, equivalence_paired(oracle::numbers(input.at("x")), oracle::numbers(input.at("y")),
                                      {input.at("low").get<double>(), input.at("high").get<double>()}));
  }
}

TEST(EquivalenceTest, IsTheIntervalInsideTheMargins) {
  std::mt19937_64 random(2);
  int shown = 0;
  for (int i = 0; i < 300; ++i) {
    const auto x = sampling::normal(random, 20, 0.1), y = sampling::normal(random, 20);
    const auto got = equivalence_paired(x, y, {-0.7, 0.7});
    ASSERT_TRUE(got);
    const bool inside = got->ci[0] > -0.7 && got->ci[1] < 0.7;
    EXPECT_EQ(got->p < 0.05, inside);
    shown += inside;
  }
  EXPECT_GT(shown, 20);
  EXPECT_LT(shown, 280);
}

TEST(EquivalenceTest, SwappingSidesMirrorsTheMargins) {
  const Values x{4.1, 5, 3.2, 4.8, 4.4, 5.5}, y{4, 5.1, 3.9, 4.2, 4.9, 4.6};
  const auto a = equivalence_paired(x, y, {-0.3, 0.8}), b = equivalence_paired(y, x, {-0.8, 0.3});
  ASSERT_TRUE(a && b);
  EXPECT_DOUBLE_EQ(a->p_lower, b->p_upper);
  EXPECT_DOUBLE_EQ(a->p_upper, b->p_lower);
  EXPECT_DOUBLE_EQ(a->ci[0], -b->ci[1]);
}

TEST(EquivalenceTest, FollowsOrderShiftAndScale) {
  const Values x{4, 5, 3, 5, 4.5, 5.5}, y{4, 5.5, 4, 4.25, 5, 4.5};
  const auto base = equivalence_paired(x, y, {-0.5, 0.5});
  for (const double scale : {0x1p-490, 0x1p480}) {
    Values sx(x.rbegin(), x.rend()), sy(y.rbegin(), y.rend());
    for (auto& v : sx) v = (v + 0x1p40) * scale;
    for (auto& v : sy) v = (v + 0x1p40) * scale;
    const Margins margins{-0.5 * scale, 0.5 * scale};
    const auto got = equivalence_paired(sx, sy, margins);
    ASSERT_TRUE(base && got);
    EXPECT_NEAR(got->p, base->p, 1e-13);
    EXPECT_NEAR(got->ci[1], base->ci[1] * scale, 1e-13 * scale);
  }
}

TEST(EquivalenceTest, AtTheMarginTheErrorRateIsAlpha) {
  // The true difference is one of the margins. The one-sided p against that margin is uniform; with margins
  // this far apart the test against the other margin hardly ever decides.
  constexpr std::size_t sets = 3000;
  std::mt19937_64 random(17);
  std::vector<double> p;
  for (std::size_t i = 0; i < sets; ++i)
    p.push_back(equivalence_paired(sampling::normal(random, 16, 50), Values(16, 0.0), {-50, 50})->p);
  EXPECT_LT(sampling::uniform_distance(p), sampling::critical_distance(sets));
}

TEST(EquivalenceTest, RefusesAndRejects) {
  EXPECT_FALSE(equivalence_paired(Values(8, 4.0), Values(8, 4.0), {}).reason().empty());
  EXPECT_FALSE(equivalence_paired(Values{1, unknown}, Values{2, 3}, {}).reason().empty());
  EXPECT_THROW(equivalence_paired(Values{1, 2}, Values{0, 0}, {1, 1}), std::invalid_argument);
  EXPECT_THROW(equivalence_paired(Values{1, 2}, Values{0, 0}, {-unknown, 1}), std::invalid_argument);
  EXPECT_THROW(equivalence_paired(Values{1, 2}, Values{0, 0}, {}, 0.5), std::invalid_argument);
}

}  // namespace
