#pragma once
/// Student's and Welch's t-tests with effect sizes.
///
/// NaN = missing: a pair is dropped if x or y is missing, and an independent group drops its missing values.
/// Means and variances are exact to double-double, so t depends only on the doubles given, whatever their
/// offset or scale. Refused: too few values, an infinite value, data that are constant up to rounding
/// (standard error below 10 eps of the largest mean, as R's t.test does), and a t beyond the range of double.
/// std::invalid_argument: pairs of different length, confidence outside (0, 1), null value not finite.

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "stats/inference/distributions.hpp"
#include "stats/result.hpp"

namespace stats {

struct TTestOptions {
  Alternative alternative = Alternative::TwoSided;
  double confidence = 0.95;  ///< confidence of `ci` and of the effect size's interval
  double null_value = 0;     ///< mean (one sample) or difference of means under the null hypothesis
  /// False leaves out the intervals of effect sizes, whose ends become infinite. Simulations set it to false,
  /// because these intervals take far longer than the test.
  bool effect_intervals = true;
};

/// Fields of every t-test.
struct TTest {
  double estimate = 0;  ///< mean, or mean(x) - mean(y), in the data's unit
  double stderr_estimate = 0;
  double t = 0;   ///< (estimate - null_value) / stderr_estimate
  double df = 0;  ///< degrees of freedom; not whole for Welch's test
  double p = 0;
  std::array<double, 2> ci{};  ///< interval for `estimate`; one end is infinite for a one-sided alternative
  std::size_t n_missing = 0;   ///< values, or pairs, left out
};

struct OneSampleTTest : TTest {
  std::size_t n = 0;
  double mean = 0, sd = 0;
  double cohen_d = 0;                  ///< (mean - null_value) / sd
  std::array<double, 2> cohen_d_ci{};  ///< interval by the noncentral t; always two-sided
};

/// Standardised differences follow Lakens (2013). Below, difference = mean_x - mean_y - null_value.
struct PairedTTest : TTest {
  std::size_t n = 0;  ///< number of pairs
  double mean_x = 0, mean_y = 0, sd_x = 0, sd_y = 0, sd_difference = 0;
  std::optional<double> r;                            ///< correlation; empty when one side is constant
  double cohen_dz = 0;                                ///< difference / sd of the differences
  std::optional<double> hedges_gz;                    ///< dz times Hedges' factor; empty with two pairs
  std::optional<double> cohen_dav;                    ///< difference / root of the mean of both variances
  std::optional<double> cohen_drm;                    ///< dz sqrt(2 (1 - r)); empty without r
  std::array<double, 2> cohen_dz_ci{};                ///< interval by the noncentral t; always two-sided
  std::optional<std::array<double, 2>> hedges_gz_ci;  ///< cohen_dz_ci times Hedges' factor
};

struct IndependentTTest : TTest {
  std::size_t n_x = 0, n_y = 0;
  double mean_x = 0, mean_y = 0;
  std::optional<double> sd_x, sd_y;  ///< empty for a group of one
  double sd_pooled = 0;
  double cohen_ds = 0;                  ///< difference / pooled sd (refused if the pooled sd is zero)
  std::optional<double> hedges_gs;      ///< ds times Hedges' factor; empty with one degree of freedom
  std::optional<double> glass_delta;    ///< difference / sd of y; empty if y is constant or one value
  std::array<double, 2> cohen_ds_ci{};  ///< interval by the noncentral t; always two-sided
};

/// Tests the mean of x against null_value. Needs two values.
Result<OneSampleTTest> t_test_one(std::span<const double> x, const TTestOptions& options = {});
/// Tests the mean of x - y over pairs against null_value. Needs two pairs.
Result<PairedTTest> t_test_paired(std::span<const double> x, std::span<const double> y,
                                  const TTestOptions& options = {});
/// Compares the means of two groups with equal variances (Student). Needs one value in each group and three
/// in all.
Result<IndependentTTest> t_test_independent(std::span<const double> x, std::span<const double> y,
                                            const TTestOptions& options = {});
/// Compares the means of two groups with unequal variances (Welch 1947, Satterthwaite's df). Needs two values
/// in each group. The effect sizes are those of the pooled test.
Result<IndependentTTest> t_test_welch(std::span<const double> x, std::span<const double> y,
                                      const TTestOptions& options = {});

}  // namespace stats
