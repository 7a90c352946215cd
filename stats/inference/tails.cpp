#include "stats/inference/tails.hpp"

#include <gsl/gsl_cdf.h>
#include <math.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "stats/gsl_errors.hpp"
#include "stats/root.hpp"

namespace stats {

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

/// ln p. A small p keeps its digits itself; a large p keeps them in q = 1 - p.
double log_part(double p, double q) { return p < q ? std::log(p) : std::log1p(-q); }

/// Continued fraction of the incomplete beta function, modified Lentz.
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

/// For x below about a / (a + b), where the fraction converges fast.
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
    throw std::invalid_argument("a probability must lie between 0 and 1");
  if (!(a >= 0.5 && b >= 0.5)) throw std::invalid_argument("beta_quantile: a and b must be at least 0.5");
  const auto part = [](double logit) { return 1 / (1 + std::exp(-logit)); };
  const auto miss = [&](double logit) {
    const double x = part(logit), y = part(-logit);
    // The smaller tail has more digits.
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
