#include "stats/analysis/declared_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "stats/inference/linear_mixed.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using namespace stats;
using oracle::expect_field;
using ::testing::HasSubstr;

std::vector<ExactMean> means(const std::vector<double>& values) {
  std::vector<ExactMean> out;
  for (const double value : values) out.push_back({value, 1});
  return out;
}

Alternative side_of(const base::Json& input) {
  const auto word = input.at("alternative").get<std::string>();
  return alternative_of(word == "two.sided" ? "two-sided" : word);
}

void expect_interval(const base::Json& c, const char* field, const std::array<double, 2>& got, double scale) {
  if (!oracle::asks(c.at("expect"), field)) return;
  for (std::size_t i = 0; i < 2; ++i)
    oracle::expect_number(c.at("id").get<std::string>() + ": " + field, got[i],
                          c.at("expect").at(field).at(i), c.at("rtol").get<double>(), scale);
}

TEST(DeclaredTest, TTestsAreThoseOfR) {
  int compared = 0;
  for (const auto& c : oracle::cases("ttest")) {
    const auto op = c.at("op").get<std::string>();
    const auto& input = c.at("input");
    if (op == "t.one" && input.value("mu", 0.0) != 0) continue;
    const auto x = oracle::numbers(input.at("x"));
    // A test against a constant, here 0, is a paired test whose second condition is the constant.
    const auto y = op == "t.one" ? std::vector<double>(x.size(), 0.0) : oracle::numbers(input.at("y"));
    DeclaredTest test;
    test.kind = op == "t.indep" ? TestKind::StudentT : op == "t.welch" ? TestKind::WelchT : TestKind::PairedT;
    test.alternative = side_of(input);
    test.confidence = input.value("conf", 0.95);
    const auto got = run_declared(test, means(x), means(y));
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
      continue;
    }
    ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
    expect_field(c, "t", got->value);
    expect_field(c, "df", got->df);
    expect_field(c, "p", got->p);
    const double scale = got->value == 0 ? 1 : std::abs(got->estimate / got->value);
    expect_field(c, "estimate", got->estimate, scale);
    expect_interval(c, "ci", *got->ci, scale);
    expect_field(c, op == "t.paired" ? "cohen_dz" : "cohen_ds", got->effect_size);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(DeclaredTest, EquivalenceSignedRanksAndSignsAreThoseOfR) {
  for (const auto& c : oracle::cases("tost")) {
    if (c.at("op") != "tost.paired") continue;
    const auto& input = c.at("input");
    const double low = input.at("low").get<double>(), high = input.at("high").get<double>();
    if (low != -high) continue;
    const auto got =
        run_declared({TestKind::Tost, Alternative::TwoSided, high, 0.95},
                     means(oracle::numbers(input.at("x"))), means(oracle::numbers(input.at("y"))));
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
      continue;
    }
    ASSERT_TRUE(got) << c.at("id");
    expect_field(c, "p_tost", got->p);
    expect_field(c, "df", got->df);
    expect_interval(c, "ci90", *got->ci, 1);
  }
  for (const auto& c : oracle::cases("wilcoxon")) {
    if (c.at("op") != "wilcoxon.signed") continue;
    const auto d = oracle::numbers(c.at("input").at("d"));
    const std::vector<ExactMean> zeros(d.size(), {0, 1});
    const auto run = [&](Alternative side) {
      return run_declared({TestKind::Wilcoxon, side}, means(d), zeros);
    };
    const auto got = run(Alternative::TwoSided);
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
      continue;
    }
    ASSERT_TRUE(got) << c.at("id");
    expect_field(c, "W_plus", got->value);
    expect_field(c, "rank_biserial", got->effect_size);
    expect_field(c, "hodges_lehmann", got->estimate);
    if (d.size() > 1000) continue;
    expect_field(c, "p_exact_conditional_two", got->p);
    expect_field(c, "p_exact_less", run(Alternative::Less)->p);
    expect_field(c, "p_exact_greater", run(Alternative::Greater)->p);
  }
  int signs = 0;
  for (const auto& c : oracle::cases("binomial")) {
    const auto& input = c.at("input");
    const double k = oracle::number(input.at("k")), n = oracle::number(input.at("n"));
    if (input.at("p0") != 0.5 || !(n >= 1 && n <= 1000 && k <= n)) continue;
    std::vector<ExactMean> a(static_cast<std::size_t>(n)), b(a.size(), {3, 1});
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = {static_cast<double>(i) < k ? 4.0 : 2.0, 1};
    const auto got = run_declared({TestKind::SignTest, side_of(input)}, a, b);
    ASSERT_TRUE(got) << c.at("id");
    expect_field(c, "p", got->p);
    expect_field(c, "estimate", got->estimate);
    ++signs;
  }
  EXPECT_GT(signs, 5);
}

TEST(DeclaredTest, AMarginMakesAOneSidedTTestOneOfNonInferiority) {
  const auto a = means({4.1, 5.2, 3.9, 4.8, 5.0}), b = means({4.4, 5.0, 4.3, 4.7, 5.3});
  std::vector<ExactMean> raised = a;
  for (ExactMean& one : raised) one.sum += 0.5;
  const auto margin = run_declared({TestKind::PairedT, Alternative::Greater, 0.5}, a, b);
  const auto moved = run_declared({TestKind::PairedT, Alternative::Greater}, raised, b);
  EXPECT_NEAR(margin->p, moved->p, 1e-12);
  EXPECT_NEAR(margin->estimate, moved->estimate - 0.5, 1e-12);
  EXPECT_THROW(run_declared({TestKind::PairedT, Alternative::TwoSided, 0.5}, a, b), std::invalid_argument);
  EXPECT_THROW(run_declared({TestKind::Tost}, a, b), std::invalid_argument);
  EXPECT_THROW(run_declared({TestKind::Wilcoxon, Alternative::Less, 0.5}, a, b), std::invalid_argument);
}

/// Answers of 12 people to 3 trials of each of two conditions; a is higher by `shift`.
AnswerRows made_answers(double shift) {
  AnswerRows out;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int person = 0; person < 12; ++person) {
    const double own = normal(random);
    for (int condition = 0; condition < 2; ++condition)
      for (int trial = 0; trial < 3; ++trial) {
        const double raw = 4 + own + (condition == 0 ? shift : 0) + normal(random);
        out.answer.push_back(std::clamp(std::round(raw), 1.0, 7.0));
        out.participant.push_back(person);
        out.condition.push_back(condition);
      }
  }
  return out;
}

TEST(DeclaredTest, ModelsAreTheValidatedFits) {
  const AnswerRows rows = made_answers(1.5);
  Predictor a{"a", {}};
  for (const int condition : rows.condition) a.values.push_back(condition == 0 ? 1 : 0);
  const std::vector<Predictor> terms{{"one", std::vector<double>(rows.answer.size(), 1)}, a};
  const auto want =
      fit_linear_mixed(rows.answer, terms, rows.participant, rows.condition)->contrast(std::vector{0.0, 1.0});
  const auto mixed = run_declared({TestKind::LinearMixed}, rows);
  ASSERT_TRUE(mixed) << mixed.reason();
  EXPECT_DOUBLE_EQ(mixed->p, want.p);
  EXPECT_DOUBLE_EQ(mixed->estimate, want.estimate);
  EXPECT_EQ(mixed->n_a, 12);
  EXPECT_FALSE(mixed->groups);
  AnswerRows apart = rows;
  for (std::size_t i = 0; i < apart.participant.size(); ++i) apart.participant[i] += 12 * apart.condition[i];
  const auto groups = run_declared({TestKind::LinearMixed}, apart);
  ASSERT_TRUE(groups) << groups.reason();
  EXPECT_TRUE(groups->groups);
  EXPECT_EQ(groups->n_b, 12);
  EXPECT_EQ(groups->note, "") << "a group's people have one condition each: no part by condition is missing";
  const auto above = run_declared({TestKind::LinearMixed, Alternative::Greater}, rows);
  EXPECT_DOUBLE_EQ(above->p, want.p / 2);
  EXPECT_TRUE(std::isinf((*above->ci)[1]));
  EXPECT_GT((*above->ci)[0], (*mixed->ci)[0]);

  const auto fit = fit_cumulative_link_mixed(rows.answer, std::vector{a}, rows.participant, Link::Logit, 15);
  const auto link = run_declared({TestKind::CumulativeLinkMixed}, rows);
  ASSERT_TRUE(link) << link.reason();
  EXPECT_DOUBLE_EQ(link->estimate, fit->beta.front());
  EXPECT_LT(link->p, 0.01);
  EXPECT_NEAR(run_declared({TestKind::CumulativeLinkMixed, Alternative::Less}, rows)->p, 1 - link->p / 2,
              1e-12);
  EXPECT_THROW(run_declared({TestKind::PairedT}, rows), std::invalid_argument);
}

TEST(DeclaredTest, WordsNameTheKinds) {
  for (const std::string& word : test_words()) EXPECT_EQ(test_word(test_of(word)), word);
  EXPECT_THROW(test_of("anova"), std::invalid_argument);
}

TEST(DeclaredTest, MissingValuesLeaveParticipantsOut) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto got = run_declared({TestKind::PairedT}, means({1, 2, none, 4, 7}), means({2, 1, 3, none, 3}));
  EXPECT_EQ(got->n_a, 3);
  EXPECT_EQ(got->n_missing, 2);
  const auto equal = run_declared({TestKind::SignTest}, means({1, 2}), means({1, 2}));
  EXPECT_THAT(equal.reason(), HasSubstr("no participant has unequal values"));
}

}  // namespace
