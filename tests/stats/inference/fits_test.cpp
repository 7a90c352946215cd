#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stats/inference/linear_fit.hpp"
#include "stats/inference/nonlinear_fit.hpp"
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
  const auto anova = anova_one_way({x, y});
  ASSERT_TRUE(fit && test && anova);
  EXPECT_NEAR(fit->coefficients[1] / fit->standard_errors[1], test->t, 1e-14);
  EXPECT_NEAR(*fit->f_p, test->p, 1e-14);
  EXPECT_NEAR(anova->f, test->t * test->t, 1e-13);
  EXPECT_NEAR(anova->p, test->p, 1e-14);
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

TEST(Anova, RefusesWhatHasNoF) {
  EXPECT_FALSE(anova_one_way({}));
  EXPECT_FALSE(anova_one_way({{1, 2, 3}}));
  EXPECT_FALSE(anova_one_way({{1, 2, 3}, {unknown}})) << "a group is missing";
  EXPECT_FALSE(anova_one_way({{1}, {2}, {3}}));
  EXPECT_EQ(anova_one_way({{0.1, 0.1, 0.1}, {0.7, 0.7, 0.7}}).reason(),
            "all values within the groups are equal");
  EXPECT_FALSE(anova_one_way({{1, 2}, {infinite, 3}}));
}

TEST(Anova, PValuesAreUniformUnderTheNull) {
  constexpr std::size_t sets = 4000;
  std::mt19937_64 random(14);
  std::vector<double> p;
  for (std::size_t i = 0; i < sets; ++i) {
    p.push_back(anova_one_way({sampling::normal(random, 4, 7), sampling::normal(random, 6, 7),
                               sampling::normal(random, 5, 7)})
                    ->p);
  }
  EXPECT_LT(sampling::uniform_distance(p), sampling::critical_distance(sets));
}

/// y = b1 exp(-b2 x).
NonlinearModel decay(const Values& x, const Values& y) {
  return {2, x.size(),
          [x, y](std::span<const double> b, std::span<double> r) {
            for (std::size_t i = 0; i < x.size(); ++i) r[i] = b[0] * std::exp(-b[1] * x[i]) - y[i];
          },
          [x](std::span<const double> b, std::span<double> j) {
            for (std::size_t i = 0; i < x.size(); ++i) {
              j[2 * i] = std::exp(-b[1] * x[i]);
              j[2 * i + 1] = -b[0] * x[i] * j[2 * i];
            }
          }};
}

TEST(NonlinearFit, FindsWhatMadeTheData) {
  const Values x{0, 1, 2, 3, 4};
  Values y;
  for (const double v : x) y.push_back(5 * std::exp(-0.7 * v));
  const auto fit = fit_nonlinear(decay(x, y), Values{1, 0.1});
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->parameters[0], 5, 1e-10);
  EXPECT_NEAR(fit->parameters[1], 0.7, 1e-10);
}

TEST(NonlinearFit, DoesNotBelieveTheSolver) {
  // From b2 = 800 the model is 0 but at x = 0: the solver stops there at once, b2 is not identifiable.
  const Values x{0, 1, 2, 3}, y{4, 2.1, 0.9, 0.6};
  EXPECT_EQ(fit_nonlinear(decay(x, y), Values{4, 800}).reason(), "the least squares did not converge");
  const std::vector<Values> starts{{4, 800}, {1, 1}};
  const auto fit = fit_nonlinear(decay(x, y), std::span<const Values>(starts));
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->parameters[1], 0.69, 0.05);
  EXPECT_LT(fit->relative_offset, 1e-7);
}

TEST(NonlinearFit, SaysWhyThereIsNone) {
  EXPECT_EQ(fit_nonlinear(decay({1}, {2}), Values{1, 1}).reason(), "fewer points than parameters");
  EXPECT_EQ(fit_nonlinear(decay({1, 2, 3}, {1, 2, unknown}), Values{1, 1}).reason(),
            "the model is not finite at the start");
  EXPECT_EQ(fit_nonlinear(decay({1, 2, 3}, {1, 2, 3}), Values{unknown, 1}).reason(),
            "the model is not finite at the start");
  EXPECT_FALSE(fit_nonlinear(decay({2, 2, 2}, {1, 2, 3}), Values{1, 1})) << "one x cannot tell a from b";
  EXPECT_EQ(fit_nonlinear(decay({1, 2}, {1, 2}), std::span<const Values>{}).reason(), "no start was given");
  EXPECT_THROW(fit_nonlinear(decay({1, 2}, {1, 2}), Values{1}), std::invalid_argument);
  EXPECT_THROW(fit_nonlinear(NonlinearModel{1, 2, {}, {}}, Values{1}), std::invalid_argument);
}

}  // namespace
