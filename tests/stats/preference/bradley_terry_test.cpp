#include "stats/preference/bradley_terry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using stats::bradley_terry;
using stats::BradleyTerry;
using stats::BradleyTerryMethod;
using stats::Connection;
using Values = std::vector<double>;

/// Scale of p-values for the comparison with reference answers. It is so small that only errors relative to p
/// count.
constexpr double p_scale = 1e-290;
/// Relative precision of the reference's bias-reduced (Firth) estimates, by R's brglm2; from
/// oracle/README.md.
constexpr double firth_rtol = 1e-5;

struct Table {
  Values wins;
  int items = 0;
};

Table table(const json& rows) {
  Table out;
  out.items = static_cast<int>(rows.size());
  for (const auto& row : rows) {
    const auto values = oracle::numbers(row);
    out.wins.insert(out.wins.end(), values.begin(), values.end());
  }
  return out;
}

void expect_list(const json& c, const std::string& field, const Values& got, double scale = 1,
                 std::optional<double> rtol = {}) {
  if (!oracle::asks(c.at("expect"), field)) return;
  Values want;
  for (const auto& item : c.at("expect").at(field)) {
    const auto values = item.is_array() ? oracle::numbers(item) : Values{oracle::number(item)};
    want.insert(want.end(), values.begin(), values.end());
  }
  ASSERT_EQ(got.size(), want.size()) << c.at("id") << ": " << field;
  for (std::size_t i = 0; i < want.size(); ++i)
    oracle::expect_number(c.at("id").get<std::string>() + ": " + field, got[i], want[i],
                          rtol.value_or(c.at("rtol").get<double>()), scale);
}

template <class Field>
Values of_pairs(const BradleyTerry& fit, const Field& field) {
  Values out;
  for (const auto& pair : fit.pairs) out.push_back(field(pair));
  return out;
}

void expect_likelihood(const json& c, const BradleyTerry& fit) {
  oracle::expect_known_fields(
      c, {"lambda_ref1", "se_ref1", "lambda_sum0", "se_sum0", "vcov_ref1", "worth_sum1", "loglik_kernel",
          "gof_deviance", "gof_df", "gof_p", "lrt_equal_chi2", "lrt_equal_df", "lrt_equal_p", "pairs_ij",
          "pair_diff", "pair_se", "pair_p_wald", "firth_lambda_ref1"});
  expect_list(c, "lambda_ref1", fit.lambda_ref1);
  expect_list(c, "se_ref1", fit.se_ref1);
  expect_list(c, "lambda_sum0", fit.lambda_sum0);
  expect_list(c, "se_sum0", fit.se_sum0);
  expect_list(c, "vcov_ref1", fit.covariance_ref1);
  expect_list(c, "worth_sum1", fit.worth);
  oracle::expect_field(c, "loglik_kernel", fit.log_likelihood);
  oracle::expect_field(c, "gof_deviance", fit.gof_deviance);
  oracle::expect_field(c, "gof_df", fit.gof_df);
  oracle::expect_field(c, "gof_p", fit.gof_p);
  oracle::expect_field(c, "lrt_equal_chi2", fit.lrt_chi2);
  oracle::expect_field(c, "lrt_equal_df", fit.lrt_df);
  oracle::expect_field(c, "lrt_equal_p", fit.lrt_p, p_scale);
  Values numbers;
  for (const auto& pair : fit.pairs) numbers.insert(numbers.end(), {pair.i + 1.0, pair.j + 1.0});
  expect_list(c, "pairs_ij", numbers);
  expect_list(c, "pair_diff", of_pairs(fit, [](const auto& p) { return p.difference; }));
  expect_list(c, "pair_se", of_pairs(fit, [](const auto& p) { return p.se; }));
  expect_list(c, "pair_p_wald", of_pairs(fit, [](const auto& p) { return p.p; }), p_scale);
}

TEST(BradleyTerry, AgreesWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("bradley_terry")) {
    const auto [wins, items] = table(c.at("input").at("wins_row_beats_col"));
    const auto likely = bradley_terry(wins, items, BradleyTerryMethod::MaximumLikelihood);
    if (c.at("expect").at("status") == "ok") {
      ASSERT_TRUE(likely) << c.at("id") << ": " << likely.reason();
      expect_likelihood(c, *likely);
    } else {
      oracle::expect_refused(c, likely);
    }
    const auto reduced = bradley_terry(wins, items, BradleyTerryMethod::BiasReduced);
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, reduced);
      oracle::expect_refused(c, bradley_terry(wins, items));
      continue;
    }
    ASSERT_TRUE(reduced) << c.at("id") << ": " << reduced.reason();
    expect_list(c, "firth_lambda_ref1", reduced->lambda_ref1, 1, firth_rtol);
    // The default is the maximum-likelihood estimate if it is finite, otherwise the bias-reduced one.
    const auto chosen = bradley_terry(wins, items);
    EXPECT_EQ(chosen->bias_reduced, !likely) << c.at("id");
    EXPECT_EQ(chosen->lambda_ref1, (likely ? *likely : *reduced).lambda_ref1) << c.at("id");
    EXPECT_EQ(chosen->why_bias_reduced.empty(), static_cast<bool>(likely)) << c.at("id");
  }
}

TEST(BradleyTerry, TwoItemsAreOneProportion) {
  const auto fit = bradley_terry(Values{0, 19, 7, 0}, 2);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->worth[0], 19.0 / 26, 1e-14);
  EXPECT_NEAR(fit->pairs[0].probability, 19.0 / 26, 1e-14);
  EXPECT_NEAR(fit->pairs[0].se, std::sqrt(1.0 / 19 + 1.0 / 7), 1e-13);
  EXPECT_FALSE(fit->gof_p) << "no degree of freedom is left";
  // Firth's estimate of one proportion adds half an answer to each side.
  const auto all = bradley_terry(Values{0, 26, 0, 0}, 2);
  ASSERT_TRUE(all) << all.reason();
  EXPECT_TRUE(all->bias_reduced);
  EXPECT_NEAR(all->pairs[0].difference, std::log(26.5 / 0.5), 1e-10);
}

/// Answers of n people to every pair of methods whose strengths are `lambda`, in logits.
Values simulate(const Values& lambda, int n, uniformity::Draws& draws) {
  const std::size_t items = lambda.size();
  Values wins(items * items, 0.0);
  for (std::size_t i = 0; i < items; ++i) {
    for (std::size_t j = i + 1; j < items; ++j) {
      for (int person = 0; person < n; ++person)
        ++wins[draws.coin(1 / (1 + std::exp(lambda[j] - lambda[i]))) ? i * items + j : j * items + i];
    }
  }
  return wins;
}

TEST(BradleyTerry, OrderOfTheItemsDoesNotMatter) {
  uniformity::Draws draws(1);
  const Values wins = simulate({0, 0.4, -0.3, 1, 0.2}, 26, draws);
  const std::vector<std::size_t> order{3, 0, 4, 2, 1};
  Values turned(25);
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 5; ++j) turned[i * 5 + j] = wins[order[i] * 5 + order[j]];
  for (const auto method : {BradleyTerryMethod::MaximumLikelihood, BradleyTerryMethod::BiasReduced}) {
    const auto one = bradley_terry(wins, 5, method), other = bradley_terry(turned, 5, method);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(other->lambda_sum0[i], one->lambda_sum0[order[i]], 1e-10);
      EXPECT_NEAR(other->se_sum0[i], one->se_sum0[order[i]], 1e-10);
    }
    EXPECT_NEAR(one->lrt_chi2, other->lrt_chi2, 1e-9);
    EXPECT_NEAR(one->gof_deviance, other->gof_deviance, 1e-9);
  }
}

TEST(BradleyTerry, SwappingWinnersAndLosersTurnsTheSigns) {
  uniformity::Draws draws(2);
  const Values wins = simulate({0, 0.4, -0.3, 1}, 26, draws);
  Values turned(16);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) turned[i * 4 + j] = wins[j * 4 + i];
  const auto one = bradley_terry(wins, 4), other = bradley_terry(turned, 4);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(other->lambda_sum0[i], -one->lambda_sum0[i], 1e-11);
  EXPECT_NEAR(one->gof_deviance, other->gof_deviance, 1e-10);
}

TEST(BradleyTerry, ExpectedWinsEqualThoseSeen) {
  // The likelihood equations (Bradley and Terry 1952): what a maximum must satisfy.
  uniformity::Draws draws(3);
  const Values wins = simulate({0, 0.9, -1.2, 0.3, 0.1}, 26, draws);
  const auto fit = bradley_terry(wins, 5);
  for (std::size_t i = 0; i < 5; ++i) {
    double seen = 0, expected = 0;
    for (std::size_t j = 0; j < 5; ++j) {
      seen += wins[i * 5 + j];
      if (j != i)
        expected += (wins[i * 5 + j] + wins[j * 5 + i]) * fit->worth[i] / (fit->worth[i] + fit->worth[j]);
    }
    EXPECT_NEAR(expected, seen, 1e-9);
  }
  EXPECT_NEAR(std::accumulate(fit->worth.begin(), fit->worth.end(), 0.0), 1, 1e-14);
  EXPECT_NEAR(std::accumulate(fit->lambda_sum0.begin(), fit->lambda_sum0.end(), 0.0), 0, 1e-12);
}

TEST(BradleyTerry, IntervalsCoverTheTruth) {
  const Values truth{-0.6, -0.3, 0.1, 0.3, 0.5};
  uniformity::Draws draws(4);
  int covered = 0, counted = 0;
  for (int study = 0; study < 1000; ++study) {
    const auto fit = bradley_terry(simulate(truth, 26, draws), 5);
    for (std::size_t i = 0; i < 5; ++i, ++counted)
      covered += fit->ci_sum0[i][0] <= truth[i] && truth[i] <= fit->ci_sum0[i][1];
  }
  EXPECT_NEAR(covered / double(counted), 0.95, 0.015);
}

TEST(BradleyTerry, PIsUniformWhenAllAreEqual) {
  uniformity::Draws draws(5);
  Values equal, fits;
  for (int study = 0; study < 2000; ++study) {
    const auto fit = bradley_terry(simulate({0, 0, 0, 0, 0}, 200, draws), 5);
    equal.push_back(fit->lrt_p);
    fits.push_back(*fit->gof_p);
  }
  EXPECT_LT(uniformity::distance(equal), uniformity::critical);
  EXPECT_LT(uniformity::distance(fits), uniformity::critical);
}

TEST(Connection, NamesWhoKeepsTheStrengthsFromBeingFinite) {
  const auto of = [](const Values& wins, int items) { return stats::connection(wins, items); };
  EXPECT_EQ(of({0, 1, 1, 0}, 2).connection, Connection::Strong);
  EXPECT_EQ(of({0, 1, 1, 0}, 2).reason, "");
  // A cycle: each of three items is beaten by one other.
  EXPECT_EQ(of({0, 1, 0, 0, 0, 1, 1, 0, 0}, 3).connection, Connection::Strong);
  const auto winner = of({0, 5, 5, 0, 0, 2, 0, 3, 0}, 3);
  EXPECT_EQ(winner.connection, Connection::Separated);
  EXPECT_EQ(winner.reason, "item 1 wins every comparison with the others");
  const auto loser = of({0, 2, 5, 3, 0, 5, 0, 0, 0}, 3);
  EXPECT_EQ(loser.connection, Connection::Separated);
  EXPECT_EQ(loser.reason, "item 3 loses every comparison with the others");
  const auto pairs = of({0, 1, 1, 1, 1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0}, 4);
  EXPECT_EQ(pairs.connection, Connection::Separated);
  EXPECT_EQ(pairs.reason, "items 1, 2 together win every comparison with the others");
  const auto apart = of({0, 1, 0, 1, 0, 0, 0, 0, 0}, 3);
  EXPECT_EQ(apart.connection, Connection::None);
  EXPECT_EQ(apart.reason, "items 1, 2 and the others were never compared");
}

TEST(BradleyTerry, SeparationIsNamedAndBiasReductionStaysFinite) {
  // Method 5 of five wins all 26 answers of each of its pairs.
  Values wins(25, 13.0);
  for (std::size_t i = 0; i < 5; ++i) wins[i * 5 + i] = 0;
  for (std::size_t i = 0; i < 4; ++i) wins[4 * 5 + i] = 26, wins[i * 5 + 4] = 0;
  const auto likely = bradley_terry(wins, 5, BradleyTerryMethod::MaximumLikelihood);
  EXPECT_EQ(likely.reason(), "infinite estimates: item 5 wins every comparison with the others");
  const auto fit = bradley_terry(wins, 5);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_TRUE(fit->bias_reduced);
  EXPECT_GT(fit->lambda_ref1[4], 4);
  EXPECT_TRUE(std::isfinite(fit->se_ref1[4]));
  EXPECT_NEAR(fit->lambda_ref1[1], 0, 1e-9);
}

TEST(BradleyTerry, RefusesWhatHasNoAnswer) {
  EXPECT_NE(bradley_terry(Values{0}, 1).reason(), "");
  EXPECT_NE(bradley_terry(Values(9, 0.0), 3).reason(), "");
  EXPECT_NE(bradley_terry(Values{0, 1, 0, 1, 0, 0, 0, 0, 0}, 3).reason(), "") << "a method is missing";
  EXPECT_THROW(bradley_terry(Values{0, 1}, 2), std::invalid_argument);
  EXPECT_THROW(bradley_terry(Values{1, 1, 1, 0}, 2), std::invalid_argument);
  EXPECT_THROW(bradley_terry(Values{0, -1, 1, 0}, 2), std::invalid_argument);
  EXPECT_THROW(bradley_terry(Values{0, std::numeric_limits<double>::quiet_NaN(), 1, 0}, 2),
               std::invalid_argument);
  EXPECT_THROW(bradley_terry(Values{0, 1, 1, 0}, 2, BradleyTerryMethod::Automatic, 1), std::invalid_argument);
}

}  // namespace
