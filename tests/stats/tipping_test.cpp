/// Tipping points: the shift, in points, by which the missing answers would have to be worse than expected to
/// change a decision. On the data completed with such answers the decision must change at the shift that is
/// found.

#include "stats/analysis/tipping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "stats/inference/distributions.hpp"
#include "stats/inference/t_test.hpp"
#include "tests/stats/analysis_fixture.hpp"

namespace stats {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Ten people have both values, two lack the first one, three lack the second one, one person lacks both.
ScoreTable table_with_missing(double lift, ScoreScale scale) {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 10; ++i) rows.push_back({3 + lift + 0.3 * (i % 4), 3 + 0.2 * (i % 3)});
  for (int i = 0; i < 2; ++i) rows.push_back({none, 3});
  for (int i = 0; i < 3; ++i) rows.push_back({4, none});
  rows.push_back({none, none});
  return test::table_of(rows, {"A", "B"}, std::move(scale));
}

struct Paired {
  double estimate, se, df, half;
};
Paired paired(const ScoreTable& table) {
  const auto t = t_test_paired(table.column(0, 0), table.column(0, 1)).value();
  return {t.estimate, t.stderr_estimate, t.df, student_upper_quantile(0.025, t.df) * t.stderr_estimate};
}

Result<TippingPoint> tip(const ScoreTable& table) {
  const auto p = paired(table);
  return tipping_point_two_sided(table, 0, 0, 1, p.estimate, p.half);
}

/// The mean difference over all planned people, if the method's missing values were worse than expected by
/// `worse`.
double filled_in(const ScoreTable& table, std::size_t method, double worse) {
  const auto x = table.column(0, 0), y = table.column(0, 1);
  const double expected = paired(table).estimate, sign = table.scale().higher_is_better ? -1 : 1;
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool whole = !std::isnan(x[i]) && !std::isnan(y[i]);
    double difference = whole ? x[i] - y[i] : expected;
    if (std::isnan(method == 0 ? x[i] : y[i])) difference += (method == 0 ? 1 : -1) * sign * worse;
    sum += difference;
  }
  return sum / static_cast<double>(x.size());
}

double p_of(double estimate, const Paired& paired) {
  return student_p(estimate / paired.se, paired.df, Alternative::TwoSided);
}

TEST(TippingPoint, IsWhereTheFilledInDifferenceReachesTheLevel) {
  for (const auto& scale : {test::realism_scale(), test::sickness_scale()}) {
    for (const double lift : {-0.9, -0.1, 0.0, 0.1, 0.9}) {
      const auto table = table_with_missing(lift, scale);
      const auto p = paired(table);
      const auto got = tip(table).value();
      EXPECT_EQ(got.planned, 16u);
      EXPECT_EQ(got.a.missing, 3u);
      EXPECT_EQ(got.b.missing, 4u);
      EXPECT_EQ(got.holds, p_of(p.estimate, p) < 0.05);
      for (const std::size_t method : {0u, 1u}) {
        const auto& side = method == 0 ? got.a : got.b;
        const bool better =
            (p.estimate > 0) == (method == 0) ? scale.higher_is_better : !scale.higher_is_better;
        EXPECT_EQ(side.shift.has_value(), !got.holds || better) << lift;
        if (!side.shift) {
          EXPECT_LT(p_of(filled_in(table, method, 100), p), 0.05);
          continue;
        }
        EXPECT_NEAR(p_of(filled_in(table, method, *side.shift), p), 0.05, 1e-9);
        const auto significant = [&](double worse) {
          return p_of(filled_in(table, method, worse), p) < 0.05;
        };
        EXPECT_EQ(significant(0.999 * *side.shift), got.holds);
        EXPECT_NE(significant(1.001 * *side.shift), got.holds);
      }
    }
  }
}

TEST(TippingPoint, BeyondTheScaleIsSaid) {
  const auto far = tip(table_with_missing(3.2, test::realism_scale())).value();
  ASSERT_TRUE(far.a.shift);
  EXPECT_GT(*far.a.shift, far.a.room);
  EXPECT_FALSE(far.a.within_scale());
  const auto near = tip(table_with_missing(0.4, test::realism_scale())).value();
  EXPECT_TRUE(near.a.within_scale());
}

TEST(TippingPoint, NobodyMissingTipsNothing) {
  const auto whole = tip(test::table_of({{1, 2}, {2, 4}, {3, 3}, {2, 5}}, {"A", "B"})).value();
  EXPECT_EQ(whole.a.missing + whole.b.missing, 0u);
  EXPECT_FALSE(whole.a.shift || whole.b.shift);
  const auto table = test::table_of({{1, none}, {none, 4}}, {"A", "B"});
  EXPECT_FALSE(tipping_point_two_sided(table, 0, 0, 1, 0, 1));
}

// A trial that was not planned is not missing.
TEST(TippingPoint, CountsThosePlannedForBoth) {
  std::vector<MethodScore> scores;
  for (int p = 0; p < 8; ++p) {
    scores.push_back({p, 0, 0, 0, 3.0 + p % 3});
    if (p < 6) scores.push_back({p, 0, 0, 1, p < 5 ? 4.0 + p % 2 : none});
  }
  const ScoreTable table{test::realism_scale(), scores, 8, {"16k"}, {"A", "B"}};
  const auto got = tip(table).value();
  EXPECT_EQ(got.planned, 6u);
  EXPECT_EQ(got.a.missing, 0u);
  EXPECT_EQ(got.b.missing, 1u);
}

// Equivalence needs both margins, so missing answers of either method can reverse it.
TEST(TippingPoint, ARangeWithTwoEndsCanBeLeftByBoth) {
  const auto table = table_with_missing(0, test::realism_scale());
  const double estimate = 0.1;
  const auto inside = tipping_point(table, 0, 0, 1, estimate, {-0.3, 0.3}).value();
  EXPECT_TRUE(inside.holds);
  EXPECT_NEAR(*inside.a.shift, 0.4 * 16 / 3, 1e-12);
  EXPECT_NEAR(*inside.b.shift, 0.2 * 16 / 4, 1e-12);
  const auto above = tipping_point(table, 0, 0, 1, 0.5, {-0.3, 0.3}).value();
  EXPECT_FALSE(above.holds);
  EXPECT_NEAR(*above.a.shift, 0.2 * 16 / 3, 1e-12);
  EXPECT_FALSE(above.b.shift);
  const auto not_worse = tipping_point(table, 0, 0, 1, 0.5, {-0.3}).value();
  EXPECT_TRUE(not_worse.holds);
  EXPECT_NEAR(*not_worse.a.shift, 0.8 * 16 / 3, 1e-12);
  EXPECT_FALSE(not_worse.b.shift);
}

}  // namespace
}  // namespace stats
