/// vip-stats power with effects as a factor.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libstudy/power/power_json.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/inference/t_test.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// protocols/foam.toml with these methods and levels.
study::PowerRequest foam_power(const std::string& methods, const std::string& levels, double effect,
                               int studies) {
  const std::string text =
      test::with_keys(test::shipped_text("foam"), {{"method", methods}, {"effects", levels}});
  study::PowerRequest request;
  request.file = "foam.toml";
  request.protocol = study::parse_protocol(text, request.file);
  request.n = {24};
  request.studies = studies;
  request.effect = effect;
  request.worlds = {"effect", "null"};
  return request;
}

double binomial(int n, int k, double p) {
  return std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(p) +
                  (n - k) * std::log(1 - p));
}

/// Exact power of the report's test if each of n people chooses once: the sum over all outcomes.
double exact_power(int n, double p) {
  double out = 0;
  for (int k = n / 2 + 1; k <= n; ++k) {
    std::vector<double> shares(static_cast<std::size_t>(n), 0);
    std::fill_n(shares.begin(), k, 1);
    const auto test = stats::t_test_one(shares, {stats::Alternative::TwoSided, 0.95, 0.5});
    if (!test || test->p < 0.05) out += binomial(n, k, p);
  }
  return out;
}

TEST(PowerEffects, OfOneAnswerAPersonIsThatOfTheReportsTest) {
  const auto request = foam_power("[\"LoRes\"]", "[\"none\", \"foam\"]", 0.75, 2000);
  const auto worlds = study::simulate_task_power(request);
  ASSERT_EQ(worlds.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(worlds[i].hypotheses.size(), 1u);
    const auto& claim = worlds[i].hypotheses.front();
    EXPECT_EQ(claim.id, "effects");
    ASSERT_EQ(claim.tests.size(), 1u);
    const auto& test = claim.tests.front();
    EXPECT_EQ(test.label, "foam over none");
    EXPECT_EQ(test.truth, i == 0 ? 0.75 : 0.5);
    EXPECT_EQ(test.claim_true, i == 0);
    const auto& at = test.curve.front();
    EXPECT_EQ(at.participants_most, 24);
    EXPECT_FALSE(at.closed_form);
    EXPECT_NEAR(at.holds.value, exact_power(24, test.truth), 4 * at.holds.se + 1e-3) << i;
    EXPECT_NEAR(at.mean_estimate, test.truth, 0.01);
    EXPECT_EQ(claim.curve.front().supported.value, at.holds.value);
  }
  EXPECT_LT(worlds[1].hypotheses.front().curve.front().any_false.value, 0.04) << "one side of .05";
}

TEST(PowerEffects, TwoMethodsGiveTwoAnswersAndMorePower) {
  const auto power = [](const std::string& methods) {
    return study::simulate_task_power(foam_power(methods, "[\"none\", \"foam\"]", 0.7, 600))
        .front()
        .hypotheses.front()
        .curve.front()
        .supported;
  };
  const auto one = power("[\"LoRes\"]"), two = power("[\"LoRes\", \"HiRes\"]");
  EXPECT_GT(two.value, one.value + 4 * (one.se + two.se));
}

/// The claim needs two tests: of foam and of scene against none. Holm corrects over all pairs of levels, also
/// over foam and scene.
TEST(PowerEffects, EveryLevelIsHeldAgainstNone) {
  auto request = foam_power("[\"LoRes\"]", "[\"foam\", \"none\", \"scene\"]", 0.8, 300);
  request.plan.plan.decision = stats::DecisionRule::Holm;
  const auto claim = study::simulate_task_power(request).front().hypotheses.front();
  ASSERT_EQ(claim.tests.size(), 2u);
  EXPECT_EQ(claim.tests[0].label, "foam over none");
  EXPECT_EQ(claim.tests[1].label, "scene over none");
  for (const auto& test : claim.tests) {
    EXPECT_TRUE(test.claim_true);
    EXPECT_NEAR(test.curve.front().mean_estimate, 0.8, 0.02) << test.label;
    EXPECT_LT(test.curve.front().holds.value, test.curve.front().uncorrected.value) << test.label;
  }
  EXPECT_LT(claim.curve.front().supported.value, claim.curve.front().any.value);
}

TEST(PowerEffects, WhatTheWorldsDoNotKnowIsRefused) {
  const auto error_of = [](const study::PowerRequest& request) {
    try {
      study::simulate_task_power(request);
    } catch (const base::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  auto request = foam_power("[\"LoRes\"]", "[\"none\", \"foam\"]", 0.7, 2);
  EXPECT_EQ(error_of(request), "");
  request.worlds = {"paper"};
  EXPECT_THAT(error_of(request),
              AllOf(HasSubstr("--world paper: cannot simulate effects, which protocol foam varies"),
                    HasSubstr("effect or null")));
  request.worlds = {"effect"};
  request.effect.reset();
  EXPECT_THAT(error_of(request), HasSubstr("--world effect: no effect was given"));
  EXPECT_THAT(error_of(foam_power("[\"LoRes\"]", "[\"scene\", \"foam\"]", 0.7, 2)),
              HasSubstr("varies effects but lacks level none"));
  request.protocol.design.pairs = false;
  EXPECT_THROW(study::power_kind(request.protocol), base::Error);
}

TEST(PowerEffects, TheJsonHasNoFigureOfThePapersRule) {
  const auto request = foam_power("[\"LoRes\"]", "[\"none\", \"foam\"]", 0.7, 50);
  const study::Json json = study::power_json(request, study::simulate_task_power(request));
  const study::Json& claim = json.at("worlds").at(0).at("hypotheses").at(0);
  EXPECT_EQ(claim.at("paper_rule"), "");
  EXPECT_FALSE(claim.at("curve").at(0).contains("paper_rule"));
  EXPECT_TRUE(claim.at("curve").at(0).contains("supported"));
}

}  // namespace
}  // namespace apps
