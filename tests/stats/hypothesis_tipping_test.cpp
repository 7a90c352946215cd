/// Tipping points of H1 to H3 (hypotheses about the realism and sickness of methods): the shift, in points,
/// by which missing answers would have to be worse than expected to change the decision of the plan. At the
/// shift that is found the decision must change.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "stats/analysis/hypotheses.hpp"
#include "stats/inference/adjust.hpp"
#include "stats/inference/distributions.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

using ::testing::HasSubstr;

/// 18 people judge five methods at two numbers of particles, in an order that rotates from person to person.
/// Every third person leaves during the second half.
std::vector<ScoreTable> tables_with_dropout(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const std::vector<double> lift{0, 0.2, 1.1, 1.0, 1.2};
  std::vector<MethodScore> realism, sickness;
  for (int p = 0; p < 18; ++p) {
    const double level = 3.5 + 0.8 * normal(generator);
    for (int trial = 0; trial < 10; ++trial) {
      const int m = (p + trial) % 5, n_star = trial / 5;
      const double gone = p % 3 == 0 && trial > 6 ? std::nan("") : 0;
      const double at = lift[static_cast<std::size_t>(m)];
      realism.push_back(
          {p, n_star, n_star, m, gone + level + at + 0.7 * normal(generator), 1, trial, n_star});
      sickness.push_back(
          {p, n_star, n_star, m, gone + 2 - at / 2 + 0.3 * normal(generator), 1, trial, n_star});
    }
  }
  return {{test::realism_scale(), realism, 18, test::n_stars, test::methods},
          {test::sickness_scale(), sickness, 18, test::n_stars, test::methods}};
}

/// p of a test if its estimate were `estimate`, and whether that points in the claimed direction.
std::pair<double, bool> p_at(const Hypothesis& claim, const HypothesisTest& test, double estimate) {
  const double up = test.score == "realism" ? 1 : -1, margin = test.margin.value_or(0),
               sides = claim.one_sided ? 1 : 2;
  const auto upper = [&](double distance) { return student_upper(distance / *test.se, *test.df); };
  if (claim.kind == HypothesisKind::Equivalence)
    return {std::min(1.0, sides * std::max(upper(estimate + margin), upper(margin - estimate))), true};
  const double distance = up * estimate + margin;
  return {sides * upper(claim.one_sided ? distance : std::abs(distance)), claim.one_sided || distance > 0};
}

bool holds_at(const Hypothesis& claim, std::size_t index, double estimate) {
  const auto [p, right] = p_at(claim, claim.tests[index], estimate);
  if (claim.decision != DecisionRule::Holm) return right && p < claim.alpha;
  std::vector<double> all;
  for (const auto& test : claim.tests) all.push_back(*test.p);
  all[index] = p;
  return right && adjust(all, Adjustment::Holm)->p[index] < claim.alpha;
}

/// For the missing answers about either of the two methods that a test compares: expects the decision to be
/// unchanged just before the shift and changed just behind it. Returns the number of shifts found.
int expect_tips(const Hypothesis& claim, std::size_t index) {
  const HypothesisTest& test = claim.tests[index];
  const TippingPoint& tipping = **test.tipping;
  EXPECT_EQ(tipping.holds, test.holds) << test.label;
  int found = 0;
  for (const bool first : {true, false}) {
    const MissingAnswers& side = first ? tipping.a : tipping.b;
    const double worse = (test.score == "realism" ? -1 : 1) * (first ? 1.0 : -1.0);
    const auto holds = [&](double shift) {
      const auto share = static_cast<double>(side.missing) / static_cast<double>(tipping.planned);
      return holds_at(claim, index, *test.estimate + worse * shift * share);
    };
    EXPECT_EQ(side.missing > 0, test.n_star == "32k") << test.label;
    if (side.shift) {
      EXPECT_EQ(holds(0.9999 * *side.shift), test.holds) << test.label;
      EXPECT_NE(holds(1.0001 * *side.shift), test.holds) << test.label;
      ++found;
    } else if (side.missing > 0) {
      for (double shift = 0; shift < 50; shift += 0.05) EXPECT_EQ(holds(shift), test.holds) << test.label;
    }
  }
  return found;
}

TEST(HypothesisTipping, TheDecisionChangesAtTheShift) {
  int found = 0, holding = 0, tests = 0;
  for (const auto model : {ScoreTests::Paired, ScoreTests::Mixed}) {
    for (const auto rule : {DecisionRule::IntersectionUnion, DecisionRule::Holm}) {
      for (const auto sided : {Directional::None, Directional::All}) {
        AnalysisPlan plan;
        plan.tests = model;
        plan.decision = rule;
        plan.directional = sided;
        const auto tables = tables_with_dropout(4);
        auto all = task1_hypotheses(tables[0], tables[1], plan, "");
        add_tipping_points(all, tables);
        for (const auto& claim : all) {
          for (std::size_t i = 0; i < claim.tests.size(); ++i) {
            ASSERT_TRUE(claim.tests[i].tipping && *claim.tests[i].tipping) << claim.tests[i].label;
            found += expect_tips(claim, i);
            holding += claim.tests[i].holds ? 1 : 0;
            ++tests;
          }
        }
      }
    }
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(holding, tests / 10);
  EXPECT_LT(holding, 9 * tests / 10);
}

// By hand: a - b of 1, 2, 3, 2, 2 has mean 2 and error sqrt(0.1); two of seven lack a. Significant beyond
// 2.776 errors (Student's .975 quantile with 4 degrees of freedom), so 2 - 2.776 * .3162 = 1.1220 remains,
// which the missing answers remove if they are worse by 1.1220 * 7 / 2 = 3.927.
TEST(HypothesisTipping, IsWhatAHandFinds) {
  const double none = std::nan("");
  const std::vector<ScoreTable> tables{
      test::table_of({{2, 1}, {4, 2}, {6, 3}, {7, 5}, {9, 7}, {none, 3}, {none, 4}}, {"Ours", "FovFluid"})};
  auto all = task1_hypotheses(tables[0], tables[0], {}, "");
  add_tipping_points(all, tables);
  const TippingPoint& got = **all[0].tests[0].tipping;
  EXPECT_TRUE(got.holds);
  EXPECT_EQ(got.planned, 7u);
  EXPECT_NEAR(*got.a.shift, 3.927, 5e-4);
  EXPECT_FALSE(got.b.shift);
  EXPECT_THAT(all[0].tests[1].tipping->reason(), HasSubstr("does not show Ours-TSp"));
}

TEST(HypothesisTipping, EqualDifferencesHaveNone) {
  std::vector<std::vector<double>> rows(8, {3, 2});
  rows.push_back({std::nan(""), 2});
  const std::vector<ScoreTable> tables{test::table_of(rows, {"Ours", "FovFluid"})};
  auto all = task1_hypotheses(tables[0], tables[0], {}, "");
  add_tipping_points(all, tables);
  const TippingPoint& got = **all[0].tests[0].tipping;
  EXPECT_TRUE(got.holds) << "by the exact sign test";
  EXPECT_EQ(got.a.missing, 1u);
  EXPECT_FALSE(got.a.shift);
  EXPECT_THAT(got.reason, HasSubstr("equal"));
}

}  // namespace
}  // namespace stats
