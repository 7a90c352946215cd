#include "stats/inference/t_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stats/inference/distributions.hpp"
#include "stats/inference/sample.hpp"

namespace stats {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
const Refusal too_few{"not enough values"};

void require_valid(const TTestOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1))
    throw std::invalid_argument(
        "t test: the confidence is not between 0 and 1; set TTestOptions::confidence to one such as 0.95");
  if (!std::isfinite(options.null_value))
    throw std::invalid_argument(
        "t test: the null value is not finite; set TTestOptions::null_value to a number");
}

/// An estimate, its standard error and the largest of the means that it is computed from, all times
/// 2^-exponent.
struct Scaled {
  Wide estimate;
  double se = 0;
  double df = 0;
  double largest_mean = 0;
  int exponent = 0;
};

/// True if the spread is only rounding of the values; no t is then defined.
bool essentially_constant(const Scaled& s) { return s.se == 0 || s.se < 10 * eps * s.largest_mean; }

std::array<double, 2> interval(double estimate, double se, double df, const TTestOptions& options) {
  const bool two_sided = options.alternative == Alternative::TwoSided;
  const double tail = (1 - options.confidence) / (two_sided ? 2 : 1);
  const double reach = student_upper_quantile(tail, df) * se;
  std::array<double, 2> out{estimate - reach, estimate + reach};
  if (options.alternative == Alternative::Less) out[0] = -HUGE_VAL;
  if (options.alternative == Alternative::Greater) out[1] = HUGE_VAL;
  return out;
}

/// Fills the fields that all t-tests share. Returns a reason if t is undefined.
std::optional<Refusal> fill(TTest& test, const Scaled& s, const TTestOptions& options) {
  if (essentially_constant(s)) return Refusal{"the values are constant, or differ by rounding only"};
  const Wide null = std::ldexp(options.null_value, -s.exponent);
  test.estimate = std::ldexp(s.estimate.value(), s.exponent);
  test.stderr_estimate = std::ldexp(s.se, s.exponent);
  test.t = (s.estimate - null).value() / s.se;
  test.df = s.df;
  if (!std::isfinite(test.t) || !std::isfinite(test.estimate) || !(test.stderr_estimate > 0) ||
      !std::isfinite(test.stderr_estimate))
    return Refusal{"t is beyond double precision"};
  test.p = student_p(test.t, test.df, options.alternative);
  test.ci = interval(test.estimate, test.stderr_estimate, test.df, options);
  return std::nullopt;
}

/// Interval of a standardised effect t * per_t.
std::array<double, 2> effect_interval(const TTest& test, double df, double per_t,
                                      const TTestOptions& options) {
  if (!options.effect_intervals) return {-HUGE_VAL, HUGE_VAL};
  const auto ncp = noncentrality_interval(test.t, df, options.confidence);
  return {ncp[0] * per_t, ncp[1] * per_t};
}

double sd(const Moments& m, int exponent) { return std::ldexp(std::sqrt(m.variance()), exponent); }
double mean(const Moments& m, int exponent) { return std::ldexp(m.mean.value(), exponent); }

/// 1 - r of two samples, exact if r is 1. Empty if a side is constant.
std::optional<double> one_minus_correlation(const Moments& x, const Moments& y, Wide cross) {
  const Wide product = x.squares * y.squares;
  if (!(product.high > 0)) return std::nullopt;
  const Wide r = cross / sqrt(product);
  if (r < Wide(0)) return std::min((Wide(1) - r).value(), 2.0);
  return std::max(((product - cross * cross) / product / (Wide(1) + r)).value(), 0.0);
}

void fill_paired_effects(PairedTTest& test, const Moments& x, const Moments& y, Wide cross, double difference,
                         const TTestOptions& options) {
  const double root_n = std::sqrt(static_cast<double>(test.n));
  test.cohen_dz = test.t / root_n;
  test.cohen_dz_ci = effect_interval(test, test.df, 1 / root_n, options);
  if (test.df > 1) {
    const double factor = hedges_factor(test.df);
    test.hedges_gz = factor * test.cohen_dz;
    test.hedges_gz_ci = {factor * test.cohen_dz_ci[0], factor * test.cohen_dz_ci[1]};
  }
  const double mean_variance = (x.variance() + y.variance()) / 2;
  if (mean_variance > 0) test.cohen_dav = difference / std::sqrt(mean_variance);
  const auto complement = one_minus_correlation(x, y, cross);
  if (!complement) return;
  test.r = 1 - *complement;
  test.cohen_drm = test.cohen_dz * std::sqrt(2 * *complement);
}

/// Moments of two independent groups, both scaled by 2^-exponent.
struct Groups {
  Moments x, y;
  int exponent = 0;
  std::size_t n_missing = 0;
};

Result<Groups> groups(std::span<const double> x, std::span<const double> y) {
  const auto a = present(x), b = present(y);
  if (!a) return Refusal{a.reason()};
  if (!b) return Refusal{b.reason()};
  Groups out;
  out.exponent = common_exponent(a->values, b->values);
  out.x = moments(scaled(a->values, out.exponent));
  out.y = moments(scaled(b->values, out.exponent));
  out.n_missing = a->n_missing + b->n_missing;
  return out;
}

struct Sizes {
  double x, y;
};
Sizes sizes(const Groups& g) { return {static_cast<double>(g.x.n), static_cast<double>(g.y.n)}; }

/// Standard error of the difference, with a common variance for both groups.
double pooled_error(const Groups& g) {
  const auto n = sizes(g);
  const double variance = ((g.x.squares + g.y.squares) / (n.x + n.y - 2)).value();
  return std::sqrt(variance * (1 / n.x + 1 / n.y));
}

Scaled contrast(const Groups& g, double se, double df) {
  return {g.x.mean - g.y.mean, se, df, std::max(std::abs(g.x.mean.high), std::abs(g.y.mean.high)),
          g.exponent};
}

void fill_groups(IndependentTTest& test, const Groups& g, const TTestOptions& options) {
  const auto n = sizes(g);
  test.n_missing = g.n_missing;
  test.n_x = g.x.n;
  test.n_y = g.y.n;
  test.mean_x = mean(g.x, g.exponent);
  test.mean_y = mean(g.y, g.exponent);
  if (g.x.n > 1) test.sd_x = sd(g.x, g.exponent);
  if (g.y.n > 1) test.sd_y = sd(g.y, g.exponent);
  // Student's and Welch's test both report the effect sizes of the pooled (Student's) test.
  const Wide null = std::ldexp(options.null_value, -g.exponent);
  const double difference = (g.x.mean - g.y.mean - null).value();
  const double se = pooled_error(g), df = n.x + n.y - 2, per_t = std::sqrt(1 / n.x + 1 / n.y);
  TTest pooled;
  pooled.t = difference / se;
  test.sd_pooled = std::ldexp(se / per_t, g.exponent);
  test.cohen_ds = pooled.t * per_t;
  test.cohen_ds_ci = effect_interval(pooled, df, per_t, options);
  if (df > 1) test.hedges_gs = hedges_factor(df) * test.cohen_ds;
  if (g.y.variance() > 0) test.glass_delta = difference / std::sqrt(g.y.variance());
}

}  // namespace

Result<OneSampleTTest> t_test_one(std::span<const double> x, const TTestOptions& options) {
  require_valid(options);
  const auto sample = present(x);
  if (!sample) return Refusal{sample.reason()};
  if (sample->values.size() < 2) return too_few;
  const int exponent = common_exponent(sample->values);
  const auto m = moments(scaled(sample->values, exponent));
  const double root_n = std::sqrt(static_cast<double>(m.n));
  OneSampleTTest test;
  test.n_missing = sample->n_missing;
  const Scaled estimate{m.mean, std::sqrt(m.variance()) / root_n, static_cast<double>(m.n - 1),
                        std::abs(m.mean.high), exponent};
  if (const auto refused = fill(test, estimate, options)) return *refused;
  test.n = m.n;
  test.mean = mean(m, exponent);
  test.sd = sd(m, exponent);
  test.cohen_d = test.t / root_n;
  test.cohen_d_ci = effect_interval(test, test.df, 1 / root_n, options);
  return test;
}

Result<PairedTTest> t_test_paired(std::span<const double> x, std::span<const double> y,
                                  const TTestOptions& options) {
  require_valid(options);
  const auto pairs = present_pairs(x, y);
  if (!pairs) return Refusal{pairs.reason()};
  if (pairs->x.size() < 2) return too_few;
  const int exponent = common_exponent(pairs->x, pairs->y);
  const auto a = scaled(pairs->x, exponent), b = scaled(pairs->y, exponent);
  std::vector<Wide> differences;
  for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(a[i] - b[i]);
  const auto of_x = moments(a), of_y = moments(b), of_d = moments(differences);
  PairedTTest test;
  test.n = pairs->x.size();
  test.n_missing = pairs->n_missing;
  const double n = static_cast<double>(test.n);
  const Scaled estimate{of_d.mean, std::sqrt(of_d.variance() / n), n - 1, std::abs(of_d.mean.high), exponent};
  if (const auto refused = fill(test, estimate, options)) return *refused;
  test.mean_x = mean(of_x, exponent);
  test.mean_y = mean(of_y, exponent);
  test.sd_x = sd(of_x, exponent);
  test.sd_y = sd(of_y, exponent);
  test.sd_difference = sd(of_d, exponent);
  const double difference = (of_d.mean - Wide(std::ldexp(options.null_value, -exponent))).value();
  fill_paired_effects(test, of_x, of_y, cross_squares(a, of_x, b, of_y), difference, options);
  return test;
}

Result<IndependentTTest> t_test_independent(std::span<const double> x, std::span<const double> y,
                                            const TTestOptions& options) {
  require_valid(options);
  const auto g = groups(x, y);
  if (!g) return Refusal{g.reason()};
  if (g->x.n < 1 || g->y.n < 1 || g->x.n + g->y.n < 3) return too_few;
  IndependentTTest test;
  const auto n = sizes(*g);
  if (const auto refused = fill(test, contrast(*g, pooled_error(*g), n.x + n.y - 2), options))
    return *refused;
  fill_groups(test, *g, options);
  return test;
}

Result<IndependentTTest> t_test_welch(std::span<const double> x, std::span<const double> y,
                                      const TTestOptions& options) {
  require_valid(options);
  const auto g = groups(x, y);
  if (!g) return Refusal{g.reason()};
  if (g->x.n < 2 || g->y.n < 2) return too_few;
  const auto n = sizes(*g);
  const double of_x = g->x.variance() / n.x, of_y = g->y.variance() / n.y, sum = of_x + of_y;
  // Satterthwaite's degrees of freedom from each group's share of the variance. Squared variances could
  // underflow; squared shares do not.
  const double share_x = of_x / sum, share_y = of_y / sum;
  const double df = 1 / (share_x * share_x / (n.x - 1) + share_y * share_y / (n.y - 1));
  IndependentTTest test;
  if (const auto refused = fill(test, contrast(*g, std::sqrt(sum), df), options)) return *refused;
  fill_groups(test, *g, options);
  return test;
}

}  // namespace stats
