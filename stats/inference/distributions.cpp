#include "stats/inference/distributions.hpp"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sf.h>
#include <math.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "stats/gsl_errors.hpp"
#include "stats/quantiles.hpp"
#include "stats/root.hpp"

namespace stats {

namespace {

void require(bool ok, const char* message) {
  if (!ok) throw std::invalid_argument(message);
}

void require_df(double df) {
  require(df > 0, "Student's t or Fisher's F: the degrees of freedom are not above 0; give a larger number");
}

/// log P(Z <= x) of the standard normal Z, for any x.
double log_normal_lower(double x) { return gsl_sf_log_erfc(-x / std::numbers::sqrt2) - std::numbers::ln2; }

/// d log P(Z <= x) / dx of the standard normal Z.
double normal_lower_slope(double x) { return gsl_sf_hazard(-x); }

/// P(Z <= t U - ncp) as an integral over y = log U, with Z standard normal and U = sqrt(chi2(df) / df).
/// `sign` is -1 for the opposite tail. The integrand's logarithm has a single maximum, since its slope
/// decreases strictly with U.
class ChiMixture {
 public:
  ChiMixture(double t, double df, double ncp, double sign)
      : t_(t), df_(df), ncp_(ncp), sign_(sign), log_scale_(log_density_scale(df)) {}

  double log_value(double y) const {
    const double u = std::exp(y);
    return log_scale_ + df_ * (y - std::expm1(2 * y) / 2) + log_normal_lower(sign_ * (t_ * u - ncp_));
  }

  double mode() const {
    const auto slope = [this](double y) {
      const double u = std::exp(y);
      const double edge = sign_ * (t_ * u - ncp_);
      return df_ * (1 - u * u) + sign_ * t_ * u * normal_lower_slope(edge);
    };
    double low = -1, high = 1;
    while (slope(low) < 0) low *= 2;
    while (slope(high) > 0) high *= 2;
    return find_root(slope, low, high);
  }

  /// The trapezoidal rule, outwards from the mode. The step resolves both factors of the integrand: the
  /// density of U (width 1/sqrt(2 df) in y) and the normal distribution function (which rises over a width of
  /// 1/ncp).
  double integral() const {
    const double centre = mode();
    const double top = log_value(centre);
    if (!(top > -1e4)) return 0;
    const double step = 0.4 / std::sqrt(2 * df_ + ncp_ * ncp_ + 16);
    double sum = 1;
    for (const double direction : {-1.0, 1.0}) {
      for (int i = 1;; ++i) {
        const double drop = log_value(centre + direction * i * step) - top;
        if (drop < -44) break;
        sum += std::exp(drop);
      }
    }
    return std::exp(top) * sum * step;
  }

 private:
  /// Log of the density of y at 0: log 2 + (df/2) log(df/2) - df/2 - log G(df/2), with the Stirling terms of
  /// the gamma function cancelled analytically.
  static double log_density_scale(double df) {
    return std::numbers::ln2 + 0.5 * std::log(df / 2) - 0.5 * std::log(2 * std::numbers::pi) -
           std::log(gsl_sf_gammastar(df / 2));
  }

  double t_, df_, ncp_, sign_, log_scale_;
};

/// P(T <= t) of the noncentral t for ncp > 60, by the trapezoidal rule over the normal variate z. The
/// chi-square probability in the integrand changes slowly with z.
double large_ncp_lower(double t, double df, double ncp) {
  if (t <= 0) return 0;
  constexpr double step = 0.25;
  double sum = 0;
  for (int i = -160; i <= 160; ++i) {
    const double z = step * i, u = (z + ncp) / t;
    sum += step * gsl_ran_ugaussian_pdf(z) * gsl_cdf_gamma_Q(df / 2 * u * u, df / 2, 1);
  }
  return sum;
}

double large_ncp_upper(double t, double df, double ncp) {
  if (t <= 0) return 1;
  constexpr double step = 0.25;
  double sum = 0;
  for (int i = -160; i <= 160; ++i) {
    const double z = step * i, u = (z + ncp) / t;
    sum += step * gsl_ran_ugaussian_pdf(z) * gsl_cdf_gamma_P(df / 2 * u * u, df / 2, 1);
  }
  return sum;
}

/// log of p / reference, bounded below so that the root finder gets a finite value where p is zero.
double log_ratio(double p, double reference) { return std::max(std::log(p / reference), -1e6); }

/// P(T >= |t|) of Student's t. For df > 5e4 GSL's incomplete beta function is only an approximation, so the
/// integral of ChiMixture replaces it.
double student_tail(double t, double df) {
  constexpr double largest_for_beta = 5e4;
  t = std::abs(t);
  if (std::isinf(t)) return 0;
  if (df > largest_for_beta) return t == 0 ? 0.5 : ChiMixture(t, df, 0, -1).integral();
  const double ratio = t * t / df;
  if (ratio < 1) return 0.5 * gsl_cdf_beta_Q(ratio / (1 + ratio), 0.5, df / 2);
  return 0.5 * gsl_cdf_beta_P(1 / (1 + ratio), df / 2, 0.5);
}

}  // namespace

double student_upper(double t, double df) {
  use_gsl_codes();
  require_df(df);
  require(!std::isnan(t), "student_upper: t is NaN; give a number");
  const double tail = student_tail(t, df);
  return t > 0 ? tail : 1 - tail;
}

double student_lower(double t, double df) { return student_upper(-t, df); }

double student_p(double t, double df, Alternative alternative) {
  if (alternative == Alternative::Less) return student_lower(t, df);
  if (alternative == Alternative::Greater) return student_upper(t, df);
  return 2 * student_upper(std::abs(t), df);
}

namespace {

/// The t > 0 with P(T >= t) = p for Student's t; requires p < 0.5.
double solve_upper_quantile(double p, double df) {
  // Solves for log t: as a function of log t, the log of the tail is smooth everywhere and nearly linear for
  // large t.
  const auto excess = [&](double log_t) { return log_ratio(student_tail(std::exp(log_t), df), p); };
  double low = -1, high = 1;
  while (excess(low) < 0) low *= 2;
  while (excess(high) > 0) high *= 2;
  return std::exp(find_root(excess, low, high));
}

}  // namespace

double student_upper_quantile(double p, double df) {
  use_gsl_codes();
  require_df(df);
  require(p > 0 && p < 1, "student_upper_quantile: p is not between 0 and 1; give a probability in (0, 1)");
  if (p > 0.5) return -student_upper_quantile(1 - p, df);
  if (p == 0.5) return 0;
  // A cache of four quantiles: tables of tests with equal numbers of people need the same ones again.
  struct Known {
    double p = 0, df = 0, value = 0;
  };
  thread_local std::array<Known, 4> known;
  thread_local std::size_t next = 0;
  for (const Known& one : known) {
    if (one.p == p && one.df == df) return one.value;
  }
  Known& one = known[next++ % known.size()];
  one = {p, df, solve_upper_quantile(p, df)};
  return one.value;
}

double noncentral_t_lower(double t, double df, double ncp) {
  use_gsl_codes();
  require_df(df);
  require(!std::isnan(t) && std::isfinite(ncp),
          "noncentral_t_lower: t is NaN or ncp is not finite; give numbers");
  if (std::isinf(t)) return t > 0 ? 1 : 0;
  constexpr double large = 60;
  if (ncp > large) return large_ncp_lower(t, df, ncp);
  if (ncp < -large) return large_ncp_upper(-t, df, -ncp);
  return ChiMixture(t, df, ncp, 1).integral();
}

double noncentral_t_upper(double t, double df, double ncp) { return noncentral_t_lower(-t, df, -ncp); }

std::array<double, 2> noncentrality_interval(double t, double df, double confidence) {
  use_gsl_codes();
  require_df(df);
  require(std::isfinite(t), "noncentrality_interval: t is not finite; give a finite number");
  require(confidence > 0 && confidence < 1,
          "noncentrality_interval: the confidence is not between 0 and 1; give one such as 0.95");
  const double tail = (1 - confidence) / 2;
  // P(T >= t) rises from 0 to 1 with the noncentrality.
  const auto bound = [&](auto probability, double direction) {
    const auto excess = [&](double ncp) { return log_ratio(probability(t, df, ncp), tail); };
    double reach = 2 + std::abs(t) / std::sqrt(df);
    double inner = t, outer = t + direction * reach;
    const double inside = excess(inner);
    if (inside < 0) {
      // With few degrees of freedom the noncentrality interval may not contain t.
      for (outer = t - direction * reach; excess(outer) < 0; outer = t - direction * reach) reach *= 2;
    } else {
      for (; excess(outer) > 0; outer = t + direction * reach) reach *= 2;
    }
    return find_root(excess, std::min(inner, outer), std::max(inner, outer));
  };
  return {bound([](double a, double b, double c) { return noncentral_t_upper(a, b, c); }, -1),
          bound([](double a, double b, double c) { return noncentral_t_lower(a, b, c); }, 1)};
}

double hedges_factor(double df) {
  use_gsl_codes();
  require(df > 1, "hedges_factor: df is not above 1; use a larger sample");
  // G(x) / (sqrt(x) G(x - 1/2)), with the Stirling terms of both gamma functions cancelled analytically.
  const double x = df / 2, below = x - 0.5;
  return std::exp((x - 1) * std::log1p(0.5 / below) - 0.5) * gsl_sf_gammastar(x) / gsl_sf_gammastar(below);
}

double fisher_upper(double x, double df1, double df2) {
  use_gsl_codes();
  require_df(df1);
  require_df(df2);
  require(x >= 0, "fisher_upper: x is below 0; give an F of 0 or more");
  if (std::isinf(x)) return 0;
  const double ratio = df1 * x / df2;
  if (ratio < 1) return gsl_cdf_beta_Q(ratio / (1 + ratio), df1 / 2, df2 / 2);
  return gsl_cdf_beta_P(1 / (1 + ratio), df2 / 2, df1 / 2);
}

namespace {

constexpr double smallest = std::numeric_limits<double>::denorm_min();
const double log_2pi = std::log(2 * std::numbers::pi);

/// ln x! minus Stirling's approximation of it.
double stirling_error(double x) {
  if (x <= 15) {
    int sign = 0;  // lgamma_r, since std::lgamma writes a global variable
    return lgamma_r(x + 1, &sign) - (x + 0.5) * std::log(x) + x - log_2pi / 2;
  }
  const double w = 1 / (x * x);
  return (1.0 / 12 -
          w * (1.0 / 360 - w * (1.0 / 1260 - w * (1.0 / 1680 - w * (1.0 / 1188 - w * 691 / 360360))))) /
         x;
}

/// ln p for p + q = 1, computed from the smaller of p and q, which has more accurate digits.
double log_part(double p, double q) { return p < q ? std::log(p) : std::log1p(-q); }

/// Continued fraction of the incomplete beta function, by the modified Lentz algorithm.
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300, precise = 1e-16;
  const auto away = [](double v) { return std::abs(v) < tiny ? tiny : v; };
  double c = 1, d = 1 / away(1 - (a + b) * x / (a + 1)), h = d;
  for (int m = 1; m < 10'000'000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away(1 + even * d);
    c = away(1 + even / c);
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away(1 + odd * d);
    c = away(1 + odd / c);
    h *= d * c;
    if (std::abs(d * c - 1) < 2 * precise) break;
  }
  return h;
}

/// ln I_x(a, b) with y = 1 - x, for x below about a / (a + b), where the continued fraction converges fast.
double log_beta_near(double a, double b, double x, double y) {
  return log_binomial_mass(a, a + b, x, y) + std::log(b / (a + b)) + std::log(beta_fraction(a, b, x));
}

}  // namespace

double deviance_part(double x, double m) {
  if (x == 0) return m;
  if (!(std::abs(x - m) < 0.1 * (x + m))) return x * std::log(x / m) + m - x;
  const double v = (x - m) / (x + m);
  double sum = (x - m) * v, power = 2 * x * v;
  for (int j = 3;; j += 2) {
    power *= v * v;
    const double next = sum + power / j;
    if (next == sum) return sum;
    sum = next;
  }
}

double log_binomial_mass(double k, double n, double p, double q) {
  const double other = n - k;
  if (p <= 0) return k == 0 ? 0 : -HUGE_VAL;
  if (q <= 0) return other == 0 ? 0 : -HUGE_VAL;
  if (k == 0) return n * log_part(q, p);
  if (other == 0) return n * log_part(p, q);
  return stirling_error(n) - stirling_error(k) - stirling_error(other) - deviance_part(k, n * p) -
         deviance_part(other, n * q) - 0.5 * (log_2pi + std::log(k) + std::log(other / n));
}

double log_beta_lower(double a, double b, double x, double y) {
  if (x <= 0) return -HUGE_VAL;
  if (y <= 0) return 0;
  if (x * (a + b + 2) < a + 1) return std::min(0.0, log_beta_near(a, b, x, y));
  return std::log1p(-std::min(1.0, std::exp(log_beta_near(b, a, y, x))));
}

double beta_quantile(double probability, double a, double b) {
  if (!(probability > 0 && probability < 1))
    throw std::invalid_argument("beta_quantile: the probability is not between 0 and 1; give one in (0, 1)");
  if (!(a >= 0.5 && b >= 0.5))
    throw std::invalid_argument("beta_quantile: a or b is below 0.5; give larger ones");
  const auto part = [](double logit) { return 1 / (1 + std::exp(-logit)); };
  const auto miss = [&](double logit) {
    const double x = part(logit), y = part(-logit);
    // Compares the smaller tail, which has more accurate digits.
    return probability <= 0.5 ? log_beta_lower(a, b, x, y) - std::log(probability)
                              : std::log1p(-probability) - log_beta_lower(b, a, y, x);
  };
  return part(find_root(miss, -700, 700));
}

double log_binomial_lower(double k, double n, double p, double q) {
  if (k < 0) return -HUGE_VAL;
  return k >= n ? 0 : log_beta_lower(n - k, k + 1, q, p);
}

double log_binomial_upper(double k, double n, double p, double q) {
  return log_binomial_lower(n - k, n, q, p);
}

double chi2_upper(double x, double df) {
  use_gsl_codes();
  if (x <= 0) return 1;
  return std::isinf(x) ? 0 : std::max(smallest, gsl_cdf_chisq_Q(x, df));
}

double normal_two_sided(double z) {
  return std::isinf(z) ? 0 : std::max(smallest, std::erfc(std::abs(z) / std::numbers::sqrt2));
}

double probability(double log_p) {
  if (log_p == -HUGE_VAL) return 0;
  return std::clamp(std::exp(log_p), smallest, 1.0);
}

}  // namespace stats
