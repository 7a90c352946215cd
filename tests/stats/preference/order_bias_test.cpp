#include "stats/preference/order_bias.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/stats/uniformity.hpp"

namespace {

using stats::Comparison;
using stats::order_bias;

/// Task 2: n people judge every pair once, in random order and with random intervals; `pull` logits favour
/// the first interval, plus `drift` for each place past the middle of the session.
std::vector<Comparison> session(int n, const std::vector<double>& lambda, double pull, double drift,
                                uniformity::Draws& draws) {
  std::vector<Comparison> out;
  const auto items = static_cast<int>(lambda.size());
  const int pairs = items * (items - 1) / 2;
  for (int person = 0; person < n; ++person) {
    for (int i = 0; i < items; ++i) {
      for (int j = i + 1; j < items; ++j) {
        Comparison t{i, j, false, 1 + std::floor(draws.uniform() * pairs)};
        if (draws.coin()) std::swap(t.first, t.second);
        const double logit = lambda[static_cast<std::size_t>(t.first)] -
                             lambda[static_cast<std::size_t>(t.second)] + pull +
                             drift * (t.position - (pairs + 1) / 2.0);
        t.first_chosen = draws.coin(1 / (1 + std::exp(-logit)));
        out.push_back(t);
      }
    }
  }
  return out;
}

const std::vector<double> strengths{-0.6, -0.3, 0.1, 0.3, 0.5};

TEST(OrderBias, TwoItemsHaveAClosedForm) {
  // Shown first, item 0 is chosen 15 of 20 times and item 1 12 of 20 times. The logits are lambda + pull and
  // -lambda + pull, so the pull is their mean.
  std::vector<Comparison> trials;
  for (int i = 0; i < 20; ++i) {
    trials.push_back({0, 1, i < 15, 1});
    trials.push_back({1, 0, i < 12, 1});
  }
  const auto got = order_bias(trials, 2);
  ASSERT_TRUE(got) << got.reason();
  const double a = std::log(15.0 / 5), b = std::log(12.0 / 8);
  EXPECT_NEAR(got->interval.estimate, (a + b) / 2, 1e-12);
  EXPECT_NEAR(got->interval.se, std::sqrt(1.0 / 15 + 1.0 / 5 + 1.0 / 12 + 1.0 / 8) / 2, 1e-12);
  EXPECT_NEAR(got->first_probability, 1 / (1 + std::exp(-(a + b) / 2)), 1e-12);
  EXPECT_EQ(got->n, 40);
  EXPECT_EQ(got->first_chosen, 27);
  EXPECT_FALSE(got->drift) << "all positions are equal";
}

TEST(OrderBias, FindsAPullAndItsDrift) {
  uniformity::Draws draws(1);
  const auto got = order_bias(session(2000, strengths, 0.4, 0.05, draws), 5);
  ASSERT_TRUE(got) << got.reason();
  EXPECT_NEAR(got->interval.estimate, 0.4, 4 * got->interval.se);
  EXPECT_LT(got->interval.se, 0.03);
  EXPECT_LT(got->interval.lrt_p, 1e-10);
  ASSERT_TRUE(got->drift);
  EXPECT_NEAR(got->drift->estimate, 0.05, 4 * got->drift->se);
  EXPECT_LT(got->drift->lrt_p, 1e-6);
}

TEST(OrderBias, PIsUniformAndIntervalsCoverWithoutBias) {
  uniformity::Draws draws(2);
  std::vector<double> interval, drift;
  int covered = 0;
  constexpr int studies = 1000;
  for (int study = 0; study < studies; ++study) {
    const auto got = order_bias(session(26, strengths, 0, 0, draws), 5);
    ASSERT_TRUE(got) << got.reason();
    interval.push_back(got->interval.lrt_p);
    drift.push_back(got->drift->lrt_p);
    covered += got->interval.ci[0] <= 0 && 0 <= got->interval.ci[1];
  }
  EXPECT_LT(uniformity::distance(interval), uniformity::critical);
  EXPECT_LT(uniformity::distance(drift), uniformity::critical);
  EXPECT_NEAR(covered / double{studies}, 0.95, 0.03);
}

TEST(OrderBias, OrderOfTrialsAndNamesOfItemsDoNotMatter) {
  uniformity::Draws draws(3);
  const auto trials = session(26, strengths, 0.3, 0, draws);
  std::vector<Comparison> other(trials.rbegin(), trials.rend());
  for (auto& t : other) t.first = 4 - t.first, t.second = 4 - t.second;
  const auto a = order_bias(trials, 5), b = order_bias(other, 5);
  EXPECT_NEAR(a->interval.estimate, b->interval.estimate, 1e-10);
  EXPECT_NEAR(a->interval.lrt_chi2, b->interval.lrt_chi2, 1e-9);
  EXPECT_NEAR(a->drift->estimate, b->drift->estimate, 1e-10);
}

TEST(OrderBias, SwappingTheIntervalsTurnsTheSign) {
  uniformity::Draws draws(4);
  const auto trials = session(26, strengths, 0.3, 0, draws);
  auto other = trials;
  for (auto& t : other) std::swap(t.first, t.second), t.first_chosen = !t.first_chosen;
  const auto a = order_bias(trials, 5), b = order_bias(other, 5);
  EXPECT_NEAR(a->interval.estimate, -b->interval.estimate, 1e-10);
  EXPECT_NEAR(a->interval.p_wald, b->interval.p_wald, 1e-10);
}

TEST(OrderBias, RefusesWhatHasNoAnswer) {
  EXPECT_NE(order_bias({}, 5).reason(), "");
  EXPECT_NE(order_bias(std::vector<Comparison>{{0, 1, true, 1}}, 3).reason(), "") << "item 3 was never shown";
  // Item 1 always comes first, so its strength and the pull cannot be separated.
  const std::vector<Comparison> one_order{{0, 1, true, 1}, {0, 1, false, 2}, {0, 1, true, 3}};
  EXPECT_NE(order_bias(one_order, 2).reason(), "");
  // The first interval always wins.
  const std::vector<Comparison> always{{0, 1, true, 1}, {1, 0, true, 2}, {0, 1, true, 3}, {1, 0, true, 4}};
  EXPECT_NE(order_bias(always, 2).reason().find("separated"), std::string::npos);
  EXPECT_THROW(order_bias(std::vector<Comparison>{{0, 2, true, 1}}, 2), std::invalid_argument);
  EXPECT_THROW(order_bias(std::vector<Comparison>{{1, 1, true, 1}}, 2), std::invalid_argument);
  EXPECT_THROW(order_bias(one_order, 2, 0), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(order_bias(std::vector<Comparison>{{0, 1, true, nan}}, 2), std::invalid_argument);
}

}  // namespace
