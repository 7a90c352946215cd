#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stats/inference/linear_fit.hpp"
#include "stats/inference/t_test.hpp"
#include "tests/stats/inference/sampling.hpp"

namespace {

using namespace stats;
using Values = std::vector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(LinearFit, LineThroughPointsByHand) {
  // x = 0..3, y = 1, 3, 2, 6: slope 1.4, intercept 0.9, rss 4.2.
  const auto fit = fit_linear({{0, 1, 2, 3}}, Values{1, 3, 2, 6});
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->coefficients[0], 0.9, 1e-15);
  EXPECT_NEAR(fit->coefficients[1], 1.4, 1e-15);
  EXPECT_NEAR(fit->rss, 4.2, 1e-14);
  EXPECT_NEAR(fit->standard_errors[1], std::sqrt(4.2 / 2 / 5), 1e-15);
  EXPECT_NEAR(*fit->r2, 0.7, 1e-15);
  EXPECT_NEAR(*fit->f, 9.8 / 2.1, 1e-14);
}

TEST(LinearFit, ADummyIsAPooledTTest) {
  const Values x{4, 5, 3, 6, 7}, y{2, 3, 3, 5};
  Values all = y, dummy(y.size(), 0.0);
  all.insert(all.end(), x.begin(), x.end());
  dummy.insert(dummy.end(), x.size(), 1.0);
  const auto fit = fit_linear({dummy}, all);
  const auto test = t_test_independent(x, y);
  ASSERT_TRUE(fit && test);
  EXPECT_NEAR(fit->coefficients[1] / fit->standard_errors[1], test->t, 1e-14);
  EXPECT_NEAR(*fit->f_p, test->p, 1e-14);
  EXPECT_NEAR(*fit->f, test->t * test->t, 1e-13);
}

TEST(LinearFit, FollowsScale) {
  const Values x{1, 2, 3, 4, 5.5}, y{2, 3, 3, 5, 9};
  const auto base = fit_linear({x}, y);
  Values sx = x, sy = y;
  for (auto& v : sx) v *= 0x1p-500;
  for (auto& v : sy) v *= 0x1p400;
  const auto fit = fit_linear({sx}, sy);
  ASSERT_TRUE(base && fit);
  EXPECT_DOUBLE_EQ(fit->coefficients[0], base->coefficients[0] * 0x1p400);
  EXPECT_DOUBLE_EQ(fit->coefficients[1], base->coefficients[1] * 0x1p900);
  EXPECT_DOUBLE_EQ(*fit->f, *base->f);
}

TEST(LinearFit, IsBlindToTheOrderOfRows) {
  std::mt19937_64 random(9);
  auto a = sampling::normal(random, 20), b = sampling::normal(random, 20, 1e9),
       y = sampling::normal(random, 20);
  const auto base = fit_linear({a, b}, y);
  for (auto* values : {&a, &b, &y}) std::reverse(values->begin(), values->end());
  const auto turned = fit_linear({a, b}, y);
  ASSERT_TRUE(base && turned);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(turned->coefficients[i], base->coefficients[i], 1e-13 * std::abs(base->coefficients[i]));
    EXPECT_NEAR(turned->standard_errors[i], base->standard_errors[i], 1e-13 * base->standard_errors[i]);
  }
}

TEST(LinearFit, SaysWhyThereIsNone) {
  EXPECT_EQ(fit_linear({{1, 2, 3}, {2, 4, 6}}, Values{1, 2, 4}).reason(), "the columns depend on each other");
  EXPECT_EQ(fit_linear({{0.1, 0.2, 0.3, 0.7}, {0.3, 0.6, 0.9, 2.1}}, Values{1, 2, 4, 3}).reason(),
            "the columns depend on each other")
      << "0.3 is not exactly three times 0.1";
  EXPECT_EQ(fit_linear({{4, 4, 4}}, Values{1, 2, 4}).reason(), "the columns depend on each other");
  EXPECT_EQ(fit_linear({{1, unknown}}, Values{1, 2}).reason(), "fewer rows than coefficients");
  EXPECT_EQ(fit_linear({{1, 2, infinite}}, Values{1, 2, 3}).reason(), "a value is infinite");
  EXPECT_THROW(fit_linear({{1, 2}}, Values{1, 2, 3}), std::invalid_argument);
  const auto exact = fit_linear({{1, 2}}, Values{1, 3});
  ASSERT_TRUE(exact);
  EXPECT_TRUE(exact->standard_errors.empty());
  EXPECT_FALSE(exact->residual_sd || exact->f);
  const auto flat = fit_linear({{1, 2, 3}}, Values{5, 5, 5});
  ASSERT_TRUE(flat);
  EXPECT_FALSE(flat->r2) << "nothing to explain";
}

}  // namespace
