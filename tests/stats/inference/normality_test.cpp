#include "stats/inference/normality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "stats/quantiles.hpp"
#include "tests/stats/inference/sampling.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using stats::shapiro_wilk;
using Values = std::vector<double>;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(ShapiroWilk, Oracle) {
  for (const auto& c : oracle::cases("shapiro")) {
    const auto got = shapiro_wilk(oracle::numbers(c.at("input").at("x")));
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
    } else {
      ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
      oracle::expect_field(c, "W", got->w);
      oracle::expect_field(c, "p", got->p);
      oracle::expect_known_fields(c, {"W", "p"});
    }
  }
}

TEST(ShapiroWilk, RefusesWhatHasNoShape) {
  EXPECT_FALSE(shapiro_wilk(Values{}));
  EXPECT_FALSE(shapiro_wilk(Values{1, 2, unknown}));
  EXPECT_EQ(shapiro_wilk(Values(20, 0.1)).reason(), "all values are equal");
  EXPECT_FALSE(shapiro_wilk(Values(5001, 1.0)));
  EXPECT_FALSE(shapiro_wilk(Values{1, 2, std::numeric_limits<double>::infinity()}));
}

TEST(ShapiroWilk, ThreeValuesHaveAClosedForm) {
  // Equally spaced: W = 1, p = 1. Two equal: W = 3/4, p = 0.
  const auto even = shapiro_wilk(Values{1, 2, 3}), worst = shapiro_wilk(Values{1, 1, 2});
  ASSERT_TRUE(even && worst);
  EXPECT_NEAR(even->w, 1, 1e-15);
  EXPECT_NEAR(even->p, 1, 1e-7);
  EXPECT_NEAR(worst->w, 0.75, 1e-15);
  EXPECT_NEAR(worst->p, 0, 1e-14);
}

TEST(ShapiroWilk, IsBlindToOrderShiftAndScale) {
  const Values x{3, 1, 4, 1.5, 5, 9, 2, 6, 5.25, 3.5};
  const auto base = shapiro_wilk(x);
  for (const double scale : {-0x1p-480, 0x1p500}) {
    Values y(x.rbegin(), x.rend());
    for (auto& v : y) v = scale * (v + 4096);
    const auto got = shapiro_wilk(y);
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->w, base->w, 1e-14);
    EXPECT_NEAR(got->p, base->p, 1e-12);
  }
}

TEST(ShapiroWilk, NormalScoresAreNormal) {
  for (const std::size_t n : {4u, 5u, 6u, 11u, 12u, 300u, 5000u}) {
    Values x;
    for (std::size_t i = 1; i <= n; ++i)
      x.push_back(stats::normal_quantile((static_cast<double>(i) - 0.375) / (static_cast<double>(n) + 0.25)));
    const auto got = shapiro_wilk(x);
    ASSERT_TRUE(got);
    EXPECT_GT(got->w, 0.985) << n;
    EXPECT_LE(got->w, 1) << n;
    EXPECT_GT(got->p, 0.9) << n;
  }
}

TEST(ShapiroWilk, PValuesAreUniformUnderTheNull) {
  // The approximation has an error of its own, below 0.01 in the distribution function, which the bound
  // allows.
  constexpr std::size_t sets = 4000;
  std::mt19937_64 random(6);
  for (const std::size_t n : {7u, 26u}) {
    std::vector<double> p;
    for (std::size_t i = 0; i < sets; ++i) p.push_back(shapiro_wilk(sampling::normal(random, n))->p);
    EXPECT_LT(sampling::uniform_distance(p), sampling::critical_distance(sets) + 0.01) << n;
  }
}

}  // namespace
