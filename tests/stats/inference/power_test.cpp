#include "stats/inference/power.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "stats/inference/binomial.hpp"
#include "stats/inference/distributions.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using oracle::number;
using stats::Alternative;
using stats::Design;
using stats::Equivalence;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

Design design(const json& input) {
  const std::string name = input.value("type", "paired");
  if (name == "two.sample") return Design::TwoSample;
  return name == "paired" ? Design::Paired : Design::OneSample;
}

Alternative side(const json& input) {
  const std::string name = input.value("alternative", "two.sided");
  if (name == "less") return Alternative::Less;
  return name == "two.sided" ? Alternative::TwoSided : Alternative::Greater;
}

void expect_t_power(const json& c) {
  const auto& in = c.at("input");
  const auto got =
      stats::t_power(number(in.at("n")), number(in.at("d")), number(in.at("alpha")), design(in), side(in));
  if (oracle::is_undefined(c)) return oracle::expect_refused(c, got);
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  oracle::expect_known_fields(c, {"power"});
  oracle::expect_field(c, "power", *got);
}

void expect_binomial_power(const json& c) {
  const auto& in = c.at("input");
  const auto got = stats::binomial_power(number(in.at("n")), number(in.at("p1")), number(in.at("p0")),
                                         number(in.at("alpha")), side(in));
  if (oracle::is_undefined(c)) return oracle::expect_refused(c, got);
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  oracle::expect_known_fields(c, {"power", "actual_alpha", "k_crit_upper"});
  oracle::expect_field(c, "power", got->power);
  oracle::expect_field(c, "actual_alpha", got->actual_alpha);
  oracle::expect_field(c, "k_crit_upper", got->k_critical_upper);
}

TEST(Power, AgreesWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("power")) {
    const std::string op = c.at("op");
    if (op == "power.t")
      expect_t_power(c);
    else if (op == "power.binom")
      expect_binomial_power(c);
    else if (op != "power.t.n")  // the project does not solve for n
      ADD_FAILURE() << c.at("id") << ": nobody tests " << op;
  }
}

// Power for the paper's 26 participants, and the numbers of participants from which the power is 0.8.
TEST(PaperNumbers, PowerOfTwentySixParticipants) {
  EXPECT_NEAR(stats::binomial_power(26, 0.70)->power, 0.46, 0.005);
  EXPECT_EQ(*stats::binomial_power(26, 0.70)->k_critical_upper, 19);
  EXPECT_NEAR(*stats::tost_power(26, {.low = -0.5, .high = 0.5, .sd = 1.3}), 0.22, 0.005);
  EXPECT_LT(stats::binomial_power(48, 0.7)->power, 0.8);
  EXPECT_GE(stats::binomial_power(49, 0.7)->power, 0.8);
  EXPECT_LT(*stats::tost_power(59, {.sd = 1.3}), 0.8);
  EXPECT_GE(*stats::tost_power(60, {.sd = 1.3}), 0.8);
}

TEST(Power, UnderTheNullItIsAlpha) {
  for (const double n : {2.0, 3.5, 26.0, 1e5}) {
    for (const double alpha : {1e-6, 0.05, 0.3}) {
      for (const auto type : {Design::Paired, Design::TwoSample}) {
        for (const auto tail : {Alternative::TwoSided, Alternative::Less, Alternative::Greater})
          EXPECT_NEAR(*stats::t_power(n, 0, alpha, type, tail) / alpha, 1, 1e-8) << n << ' ' << alpha;
      }
    }
  }
}

TEST(Power, SidesMirrorAndAddUp) {
  for (const double d : {0.1, 0.7, 2.0}) {
    const double right = *stats::t_power(12, d, 0.025, Design::Paired, Alternative::Greater);
    const double left = *stats::t_power(12, d, 0.025, Design::Paired, Alternative::Less);
    EXPECT_NEAR(*stats::t_power(12, d), right + left, 1e-12);
    EXPECT_NEAR(*stats::t_power(12, -d), right + left, 1e-12);
    EXPECT_NEAR(*stats::t_power(12, -d, 0.025, Design::Paired, Alternative::Less), right, 1e-12);
  }
}

/// Share of simulated studies in which both one-sided tests of equivalence reject.
double simulated_tost(int n, const Equivalence& e, int studies) {
  uniformity::Draws draws(9);
  const double critical = stats::student_upper_quantile(e.alpha, n - 1);
  int shown = 0;
  for (int study = 0; study < studies; ++study) {
    double mean = 0, squares = 0;
    std::vector<double> x;
    for (int i = 0; i < n; ++i) x.push_back(e.difference + e.sd * draws.normal());
    for (const double v : x) mean += v / n;
    for (const double v : x) squares += (v - mean) * (v - mean);
    const double error = std::sqrt(squares / (n - 1) / n);
    shown += (mean - e.low) / error > critical && (e.high - mean) / error > critical;
  }
  return static_cast<double>(shown) / studies;
}

TEST(TostPower, IsWhatSimulationFinds) {
  constexpr int studies = 20'000;
  for (const auto& [n, e] :
       std::vector<std::pair<int, Equivalence>>{{26, {-0.5, 0.5, 1.3, 0.0, 0.05, Design::Paired}},
                                                {26, {-0.5, 0.5, 1.0, 0.2, 0.05, Design::Paired}},
                                                {5, {-1, 2, 0.8, 0.3, 0.1, Design::Paired}},
                                                {2, {-20, 20, 1.0, 0.0, 0.05, Design::Paired}}}) {
    const double exact = *stats::tost_power(n, e);
    const double error = std::sqrt(exact * (1 - exact) / studies);
    EXPECT_NEAR(simulated_tost(n, e, studies), exact, 5 * error) << n << ' ' << e.sd;
  }
}

TEST(TostPower, AtTheMarginItIsAtMostAlpha) {
  for (const double sd : {0.1, 1.0, 1.3}) {
    const double at = *stats::tost_power(26, {.low = -0.5, .high = 0.5, .sd = sd, .difference = 0.5});
    EXPECT_LE(at, 0.05 + 1e-9) << sd;
    EXPECT_LT(*stats::tost_power(26, {.low = -0.5, .high = 0.5, .sd = sd, .difference = 0.7}), at) << sd;
  }
  EXPECT_NEAR(*stats::tost_power(26, {.sd = 0.01, .difference = 0.5}), 0.05, 1e-9)
      << "with a wide gap between the margins one test alone decides";
}

TEST(TostPower, WithOneMarginFarAwayIsTheOneSidedTest) {
  const Equivalence e{.low = -0.5, .high = 1e6, .sd = 1.3, .difference = 0.1};
  EXPECT_NEAR(*stats::tost_power(26, e),
              *stats::t_power(26, 0.6 / 1.3, 0.05, Design::Paired, Alternative::Greater), 1e-10);
  const Equivalence two{.low = -0.5, .high = 1e6, .sd = 1.3, .difference = 0.1, .design = Design::TwoSample};
  EXPECT_NEAR(*stats::tost_power(26, two),
              *stats::t_power(26, 0.6 / 1.3, 0.05, Design::TwoSample, Alternative::Greater), 1e-10);
}

TEST(BinomialPower, IsTheSumOverTheCountsThatAreSignificant) {
  for (const int n : {1, 5, 6, 26, 33}) {
    for (const double p0 : {0.5, 0.2}) {
      for (const auto tail : {Alternative::TwoSided, Alternative::Less, Alternative::Greater}) {
        double power = 0, level = 0;
        for (int k = 0; k <= n; ++k) {
          if (stats::binomial_p(k, n, p0, tail) > 0.05) continue;
          const auto mass = [&](double p) {
            return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0)) *
                   std::pow(p, k) * std::pow(1 - p, n - k);
          };
          power += mass(0.7);
          level += mass(p0);
        }
        const auto got = stats::binomial_power(n, 0.7, p0, 0.05, tail);
        EXPECT_NEAR(got->power, power, 1e-12) << n;
        EXPECT_NEAR(got->actual_alpha, level, 1e-12) << n;
      }
    }
  }
  EXPECT_FALSE(stats::binomial_power(5, 0.7)->k_critical_upper) << "no count of five is significant";
  EXPECT_EQ(stats::binomial_power(5, 0.7)->power, 0);
  EXPECT_EQ(*stats::binomial_power(6, 0.7)->k_critical_upper, 6);
  EXPECT_EQ(*stats::binomial_power(6, 0.7)->k_critical_lower, 0);
}

// R 4.2.2: power.t.test(n = 26, power = .8, type = "paired", strict = TRUE, tol = 1e-14)$delta, and the
// share at which a test that rejects where binom.test does has the power .8, by dbinom.
TEST(Power, TheSmallestEffectThatIsFoundIsThatOfR) {
  EXPECT_NEAR(*stats::t_detectable(26, 0.8), 0.571704834713, 1e-9);
  EXPECT_NEAR(*stats::binomial_detectable(26, 0.8), 0.778848249382, 1e-10);
  for (const double power : {0.3, 0.8, 0.95}) {
    EXPECT_NEAR(*stats::t_power(12, *stats::t_detectable(12, power, 0.01), 0.01), power, 1e-12);
    EXPECT_NEAR(stats::binomial_power(17, *stats::binomial_detectable(17, power))->power, power, 1e-12);
  }
  EXPECT_EQ(stats::binomial_detectable(5, 0.8).reason(),
            "too few answers: not even a choice by all is significant at this level");
  EXPECT_NE(stats::t_detectable(1, 0.8).reason(), "");
  EXPECT_NE(stats::t_detectable(26, 0.05).reason(), "");
  EXPECT_NE(stats::t_detectable(26, 1).reason(), "");
}

TEST(Power, RefusesWhatHasNoAnswer) {
  for (const double n : {1.0, 0.0, -3.0, unknown}) {
    EXPECT_NE(stats::t_power(n, 0.5).reason(), "");
    EXPECT_NE(stats::tost_power(n, {}).reason(), "");
  }
  for (const double alpha : {0.0, 1.0, unknown}) {
    EXPECT_NE(stats::t_power(26, 0.5, alpha).reason(), "");
    EXPECT_NE(stats::binomial_power(26, 0.7, 0.5, alpha).reason(), "");
    EXPECT_NE(stats::tost_power(26, {.alpha = alpha}).reason(), "");
  }
  EXPECT_NE(stats::t_power(26, unknown).reason(), "");
  EXPECT_NE(stats::tost_power(26, {.sd = 0}).reason(), "");
  EXPECT_NE(stats::tost_power(26, {.low = 1, .high = 0}).reason(), "");
  for (const double n : {0.0, 2.5, -1.0, unknown}) EXPECT_NE(stats::binomial_power(n, 0.7).reason(), "");
  EXPECT_NE(stats::binomial_power(26, 1.2).reason(), "");
}

}  // namespace
