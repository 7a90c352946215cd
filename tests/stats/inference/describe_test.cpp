#include "stats/inference/describe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"

namespace {

using stats::describe;
using stats::QuantileType;
using Values = std::vector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

void expect_description(const base::Json& c, const Values& x, const stats::Description& got) {
  using oracle::expect_field;
  const double scale = got.sd.value_or(0);
  expect_field(c, "n", static_cast<double>(got.n));
  expect_field(c, "n_missing", static_cast<double>(got.n_missing));
  expect_field(c, "mean", got.mean, scale);
  expect_field(c, "sd", got.sd);
  expect_field(c, "var", got.var);
  expect_field(c, "sem", got.sem);
  expect_field(c, "median", got.median, scale);
  expect_field(c, "min", got.min);
  expect_field(c, "max", got.max);
  expect_field(c, "mad_raw", got.mad, scale);
  expect_field(c, "q25_type7", got.q25, scale);
  expect_field(c, "q75_type7", got.q75, scale);
  expect_field(c, "q10_type7", *stats::quantile(x, 0.1), scale);
  expect_field(c, "q25_type6", *stats::quantile(x, 0.25, QuantileType::Weibull), scale);
  expect_field(c, "skew_g1", got.skewness);
  expect_field(c, "exkurt_g2", got.kurtosis);
  oracle::expect_known_fields(
      c, {"n", "n_missing", "mean", "sd", "var", "sem", "median", "min", "max", "mad_raw", "q25_type7",
          "q75_type7", "q10_type7", "q25_type6", "skew_g1", "exkurt_g2"});
}

TEST(Describe, Oracle) {
  for (const auto& c : oracle::cases("describe")) {
    const auto x = oracle::numbers(c.at("input").at("x"));
    const auto got = describe(x);
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, got);
    } else {
      ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
      expect_description(c, x, *got);
    }
  }
}

TEST(Describe, LeavesOutWhatIsNotDefined) {
  const auto one = describe(Values{3, unknown});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->mean, 3);
  EXPECT_EQ(one->n_missing, 1u);
  EXPECT_FALSE(one->sd || one->sem || one->skewness || one->kurtosis || one->autocorrelation);
  const auto same = describe(Values(7, 0.1));
  ASSERT_TRUE(same);
  EXPECT_EQ(*same->sd, 0) << "not the rounding of a mean";
  EXPECT_FALSE(same->skewness || same->kurtosis || same->autocorrelation);
  const auto vast = describe(Values{1e200, 2e200, 4e200});
  ASSERT_TRUE(vast);
  EXPECT_NEAR(*vast->sd, 1.5275252316519465e200, 1e186);
  EXPECT_FALSE(vast->var) << "1e400 is no double";
}

TEST(Describe, RefusesWhatItCannotDescribe) {
  EXPECT_EQ(describe({}).reason(), "no values");
  EXPECT_EQ(describe(Values{unknown, unknown}).reason(), "no values");
  EXPECT_EQ(describe(Values{1, infinite}).reason(), "a value is infinite");
  EXPECT_FALSE(stats::quantile({}, 0.5));
  EXPECT_FALSE(stats::box_plot({}));
  EXPECT_THROW(stats::quantile(Values{1}, 1.5), std::invalid_argument);
}

TEST(Describe, FollowsShiftScaleAndOrder) {
  const Values x{3, 1, 4, 1, 5, 9, 2, 6, 5, 3.5};
  const auto base = describe(x);
  for (const double scale : {-0x1p-490, 0x1p-3, 0x1p10, 0x1p480}) {
    for (const double offset : {0.0, -4096.0, 0x1p40}) {
      Values y;
      for (const double v : x) y.push_back(scale * (v + offset));
      std::swap(y[2], y[7]);
      const auto got = describe(y);
      ASSERT_TRUE(got);
      EXPECT_DOUBLE_EQ(got->mean, scale * (base->mean + offset));
      EXPECT_DOUBLE_EQ(*got->sd, std::abs(scale) * *base->sd);
      EXPECT_DOUBLE_EQ(got->mad, std::abs(scale) * base->mad);
      EXPECT_NEAR(*got->skewness, std::copysign(1.0, scale) * *base->skewness, 1e-14);
      EXPECT_NEAR(*got->kurtosis, *base->kurtosis, 1e-14);
    }
  }
}

// The fence is 2/3 + 1.5 * 2/3 = 5/3. In doubles it comes out slightly too small.
TEST(BoxPlot, AValueOnTheFenceIsWithin) {
  const auto box = stats::box_plot(Values{0, 0, 1.0 / 3, 2.0 / 3, 5.0 / 3});
  ASSERT_TRUE(box);
  EXPECT_EQ(box->n_outliers, 0u);
  EXPECT_EQ(box->high_whisker, 5.0 / 3);
}

TEST(BoxPlot, WhiskersEndAtValues) {
  const auto box = stats::box_plot(Values{1, 2, 3, 4, 5, 6, 7, 8, 20, unknown});
  ASSERT_TRUE(box);
  EXPECT_EQ(box->n, 9u);
  EXPECT_EQ(box->median, 5);
  EXPECT_EQ(box->q25, 3);
  EXPECT_EQ(box->q75, 7);
  EXPECT_EQ(box->low_whisker, 1);
  EXPECT_EQ(box->high_whisker, 8) << "7 + 1.5 * 4 = 13";
  EXPECT_EQ(box->n_outliers, 1u);
}

}  // namespace
