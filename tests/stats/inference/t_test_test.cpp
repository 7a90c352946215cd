#include "stats/inference/t_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/stats/inference/sampling.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using namespace stats;
using oracle::expect_field;
using Values = std::vector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double nct_rtol = 1e-6;

TTestOptions options(const base::Json& input) {
  TTestOptions out;
  const auto side = input.value("alternative", std::string("two.sided"));
  if (side == "less") out.alternative = Alternative::Less;
  if (side == "greater") out.alternative = Alternative::Greater;
  out.confidence = input.value("conf", 0.95);
  out.null_value = input.value("mu", 0.0);
  return out;
}

void expect_interval(const base::Json& c, const std::string& field, std::array<double, 2> got, double scale,
                     double rtol) {
  if (!oracle::asks(c.at("expect"), field)) return;
  for (std::size_t i = 0; i < 2; ++i) {
    oracle::expect_number(c.at("id").get<std::string>() + ": " + field, got[i],
                          c.at("expect").at(field).at(i), rtol, scale);
  }
}

void expect_common(const base::Json& c, const TTest& got) {
  expect_field(c, "t", got.t);
  expect_field(c, "df", got.df);
  expect_field(c, "p", got.p);
  expect_field(c, "estimate", got.estimate, got.stderr_estimate);
  expect_field(c, "stderr", got.stderr_estimate);
  expect_interval(c, "ci", got.ci, got.stderr_estimate, c.at("rtol").get<double>());
}

void expect_fields(const base::Json& c, const OneSampleTTest& got) {
  expect_field(c, "n", static_cast<double>(got.n));
  expect_field(c, "mean", got.mean, got.sd);
  expect_field(c, "sd", got.sd);
  expect_field(c, "cohen_d", got.cohen_d);
  expect_interval(c, "d_ci95_nct", got.cohen_d_ci, 1, nct_rtol);
  oracle::expect_known_fields(
      c, {"t", "df", "p", "estimate", "stderr", "ci", "n", "mean", "sd", "cohen_d", "d_ci95_nct"});
}

void expect_fields(const base::Json& c, const PairedTTest& got) {
  expect_field(c, "n", static_cast<double>(got.n));
  expect_field(c, "mean_x", got.mean_x, got.sd_x);
  expect_field(c, "mean_y", got.mean_y, got.sd_y);
  expect_field(c, "sd_x", got.sd_x);
  expect_field(c, "sd_y", got.sd_y);
  expect_field(c, "sd_diff", got.sd_difference);
  expect_field(c, "r", got.r);
  expect_field(c, "cohen_dz", got.cohen_dz);
  expect_field(c, "hedges_gz", got.hedges_gz);
  expect_field(c, "cohen_dav", got.cohen_dav);
  expect_field(c, "cohen_drm", got.cohen_drm);
  expect_interval(c, "dz_ci95_nct", got.cohen_dz_ci, 1, nct_rtol);
  oracle::expect_known_fields(
      c, {"t", "df", "p", "estimate", "stderr", "ci", "n", "mean_x", "mean_y", "sd_x", "sd_y", "sd_diff", "r",
          "cohen_dz", "hedges_gz", "cohen_dav", "cohen_drm", "dz_ci95_nct"});
}

void expect_fields(const base::Json& c, const IndependentTTest& got) {
  expect_field(c, "sd_pooled", got.sd_pooled);
  expect_field(c, "cohen_ds", got.cohen_ds);
  expect_field(c, "hedges_gs", got.hedges_gs);
  expect_field(c, "glass_delta_y", got.glass_delta);
  expect_interval(c, "ds_ci95_nct", got.cohen_ds_ci, 1, nct_rtol);
  oracle::expect_known_fields(c, {"t", "df", "p", "estimate", "stderr", "ci", "sd_pooled", "cohen_ds",
                                  "hedges_gs", "glass_delta_y", "ds_ci95_nct"});
}

template <class T>
void expect_case(const base::Json& c, const Result<T>& got) {
  if (oracle::is_undefined(c)) {
    oracle::expect_refused(c, got);
    return;
  }
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  expect_common(c, *got);
  expect_fields(c, *got);
}

TEST(TTest, Oracle) {
  for (const auto& c : oracle::cases("ttest")) {
    const auto& input = c.at("input");
    const auto op = c.at("op").get<std::string>();
    const auto x = oracle::numbers(input.at("x"));
    const auto y = input.contains("y") ? oracle::numbers(input.at("y")) : Values{};
    if (op == "t.one") {
      expect_case(c, t_test_one(x, options(input)));
    } else if (op == "t.paired") {
      expect_case(c, t_test_paired(x, y, options(input)));
    } else if (op == "t.indep") {
      expect_case(c, t_test_independent(x, y, options(input)));
    } else if (op == "t.welch") {
      expect_case(c, t_test_welch(x, y, options(input)));
    } else {
      ADD_FAILURE() << c.at("id") << ": unknown operation " << op;
    }
  }
}

TEST(TTest, RefusesWhatHasNoT) {
  for (const Values& few : {Values{}, Values{1}, Values{1, unknown}}) {
    EXPECT_EQ(t_test_one(few).reason(), "not enough values");
    EXPECT_EQ(t_test_paired(few, few).reason(), "not enough values");
    EXPECT_EQ(t_test_welch(few, Values{1, 2}).reason(), "not enough values");
    EXPECT_EQ(t_test_welch(Values{1, 2}, few).reason(), "not enough values");
  }
  EXPECT_EQ(t_test_independent(Values{}, Values{1, 2, 3}).reason(), "not enough values");
  EXPECT_EQ(t_test_independent(Values{1}, Values{2}).reason(), "not enough values");
  const std::string constant = "the values are constant, or differ by rounding only";
  EXPECT_EQ(t_test_one(Values(9, 0.1)).reason(), constant);
  EXPECT_EQ(t_test_one(Values{0.1 + 0.2, 0.3, 0.3}).reason(), constant);
  EXPECT_EQ(t_test_paired(Values{5, 6, 7}, Values{4, 5, 6}).reason(), constant);
  EXPECT_EQ(t_test_welch(Values{0, 0}, Values{0, 0}).reason(), constant);
  EXPECT_EQ(t_test_one(Values{1, 2, infinite}).reason(), "a value is infinite");
  EXPECT_EQ(t_test_paired(Values{1, 2, 3}, Values{1, -infinite, 4}).reason(), "a value is infinite");
  EXPECT_EQ(t_test_one(Values{1e-320, 2e-320}, {.null_value = 4}).reason(), "t is beyond double precision");
}

TEST(TTest, RejectsWrongArguments) {
  EXPECT_THROW(t_test_paired(Values{1, 2}, Values{1}), std::invalid_argument);
  EXPECT_THROW(t_test_one(Values{1, 2}, {.confidence = 1}), std::invalid_argument);
  EXPECT_THROW(t_test_one(Values{1, 2}, {.null_value = infinite}), std::invalid_argument);
}

TEST(TTest, OneValueAgainstAGroupIsAPooledTest) {
  // t = (5 - 2) / (1 sqrt(1 + 1/3)), df = 2; p = 1 - t / sqrt(2 + t^2).
  const auto got = t_test_independent(Values{5}, Values{1, 2, 3});
  ASSERT_TRUE(got);
  const double t = 3 / std::sqrt(4.0 / 3);
  EXPECT_DOUBLE_EQ(got->t, t);
  EXPECT_NEAR(got->p, 1 - t / std::sqrt(2 + t * t), 1e-15);
  EXPECT_FALSE(got->sd_x);
  EXPECT_DOUBLE_EQ(*got->sd_y, 1);
}

TEST(TTest, MissingSidesDropPairs) {
  const Values x{1, unknown, 3, 4, 6, 1}, y{2, 5, unknown, 2, 3, 7};
  const auto got = t_test_paired(x, y);
  const auto clean = t_test_paired(Values{1, 4, 6, 1}, Values{2, 2, 3, 7});
  ASSERT_TRUE(got && clean);
  EXPECT_EQ(got->n, 4u);
  EXPECT_EQ(got->n_missing, 2u);
  EXPECT_EQ(got->t, clean->t);
  const auto apart = t_test_welch(x, y);
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->n_x, 5u);
  EXPECT_EQ(apart->n_missing, 2u);
}

TEST(TTest, TinyDifferencesOnAHugeOffset) {
  // Differences of 2^-12 at 2^40: exact in doubles, but their means are not.
  Values x, y;
  for (const double v : {3.0, 5.0, 4.0, 8.0, 6.0, 9.0}) x.push_back(0x1p40 + v * 0x1p-12);
  for (const double v : {1.0, 4.0, 4.0, 5.0, 7.0, 2.0}) y.push_back(0x1p40 + v * 0x1p-12);
  const auto far = t_test_paired(x, y);
  const auto near = t_test_paired(Values{3, 5, 4, 8, 6, 9}, Values{1, 4, 4, 5, 7, 2});
  ASSERT_TRUE(far && near);
  EXPECT_DOUBLE_EQ(far->t, near->t);
  EXPECT_DOUBLE_EQ(far->p, near->p);
  EXPECT_DOUBLE_EQ(*far->r, *near->r);
  EXPECT_DOUBLE_EQ(far->estimate, near->estimate * 0x1p-12);
}

/// Every test of two samples, with the same signature.
struct NamedTest {
  const char* name;
  TTest (*run)(const Values&, const Values&, const TTestOptions&);
};
const NamedTest tests[]{{"paired",
                         [](const Values& x, const Values& y, const TTestOptions& o) -> TTest {
                           return *t_test_paired(x, y, o);
                         }},
                        {"pooled",
                         [](const Values& x, const Values& y, const TTestOptions& o) -> TTest {
                           return *t_test_independent(x, y, o);
                         }},
                        {"welch", [](const Values& x, const Values& y, const TTestOptions& o) -> TTest {
                           return *t_test_welch(x, y, o);
                         }}};

TEST(TTestProperties, OrderShiftScaleAndSwap) {
  std::mt19937_64 random(5);
  for (const auto& test : tests) {
    const auto x = sampling::normal(random, 14, 1), y = sampling::normal(random, 14, 0.4, 2);
    const auto base = test.run(x, y, {});
    Values px(x.rbegin(), x.rend()), py(y.rbegin(), y.rend());
    EXPECT_NEAR(test.run(px, py, {}).t, base.t, 1e-14) << test.name;
    const auto swapped = test.run(y, x, {});
    EXPECT_DOUBLE_EQ(swapped.t, -base.t) << test.name;
    EXPECT_DOUBLE_EQ(swapped.p, base.p) << test.name;
    EXPECT_DOUBLE_EQ(swapped.ci[0], -base.ci[1]) << test.name;
    EXPECT_DOUBLE_EQ(test.run(y, x, {.alternative = Alternative::Less}).p,
                     test.run(x, y, {.alternative = Alternative::Greater}).p)
        << test.name;
    for (const double scale : {1e-150, 1e-3, 1e150}) {
      Values sx, sy;
      for (const double v : x) sx.push_back(scale * v);
      for (const double v : y) sy.push_back(scale * v);
      const auto scaled = test.run(sx, sy, {});
      EXPECT_NEAR(scaled.t, base.t, 1e-13 * std::abs(base.t)) << test.name << scale;
      EXPECT_NEAR(scaled.p, base.p, 1e-13) << test.name << scale;
      EXPECT_NEAR(scaled.ci[1] / scale, base.ci[1], 1e-13 * std::abs(base.ci[1])) << test.name << scale;
    }
    Values ox, oy;
    for (const double v : x) ox.push_back(v + 1e6);
    for (const double v : y) oy.push_back(v + 1e6);
    EXPECT_NEAR(test.run(ox, oy, {}).t, base.t, 1e-8) << test.name << ": the sums round the data to 1e-10";
  }
}

TEST(TTestProperties, PValuesAreUniformUnderTheNull) {
  constexpr std::size_t sets = 4000;
  std::mt19937_64 random(11);
  for (const auto& test : tests) {
    for (const auto side : {Alternative::TwoSided, Alternative::Less}) {
      std::vector<double> p;
      for (std::size_t i = 0; i < sets; ++i) {
        const auto x = sampling::normal(random, 9, 3), y = sampling::normal(random, 9, 3);
        p.push_back(test.run(x, y, {.alternative = side, .effect_intervals = false}).p);
      }
      // The error of Welch's approximation is smaller than the detectable distance.
      EXPECT_LT(sampling::uniform_distance(p), sampling::critical_distance(sets)) << test.name;
    }
  }
}

TEST(TTestProperties, IntervalsOfEffectSizesCover) {
  constexpr int sets = 1500;
  constexpr double effect = 0.8;
  std::mt19937_64 random(3);
  int covered = 0;
  for (int i = 0; i < sets; ++i) {
    const auto got = t_test_one(sampling::normal(random, 12, effect));
    covered += got->cohen_d_ci[0] <= effect && effect <= got->cohen_d_ci[1];
  }
  // 0.95 -+ 3.5 standard errors of a share of 1500.
  EXPECT_NEAR(covered / static_cast<double>(sets), 0.95, 0.02);
}

}  // namespace
