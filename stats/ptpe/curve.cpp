#include "stats/ptpe/curve.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/gsl_errors.hpp"
#include "stats/quantiles.hpp"

namespace stats {

double Curve::a() const { return std::exp(log_a); }
double Curve::mu(double delta) const { return std::exp(log_a + b * delta); }

double jackknife_covariance(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 2)
    throw std::invalid_argument(
        "jackknife_covariance: x and y differ in length or have fewer than two values; give one of each for "
        "every participant left out");
  const double n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mean_x) * (y[i] - mean_y);
  return (n - 1) / n * sum;
}

double CurveSpread::a_se() const { return curve.a() * std::sqrt(var_log_a); }
double CurveSpread::b_se() const { return std::sqrt(var_b); }

BandPoint CurveSpread::band(double delta) const {
  use_gsl_codes();
  const double n = participants;
  const double variance = var_log_a + 2 * delta * cov + delta * delta * var_b;
  const double se = std::sqrt(std::max(variance, 0.0));
  const double t = student_quantile(0.5 + confidence / 2, n - 1);
  const double whole = std::sqrt(2 * (n - 1) / (n - 2) * gsl_cdf_fdist_Pinv(confidence, 2, n - 2));
  const double at = curve.log_a + curve.b * delta;
  return {delta,
          std::exp(at),
          {std::exp(at - t * se), std::exp(at + t * se)},
          {std::exp(at - whole * se), std::exp(at + whole * se)}};
}

double CurveSpread::largest_relative_half_width(std::span<const double> deltas) const {
  double largest = 0;
  for (const double delta : deltas) {
    const auto point = band(delta);
    largest = std::max(largest, (point.pointwise[1] - point.pointwise[0]) / 2 / point.mu);
  }
  return largest;
}

CurveSpread jackknife_curve(const Curve& estimate, std::span<const Curve> without_one, double confidence) {
  if (without_one.size() < 4)
    throw std::invalid_argument(
        "jackknife_curve: fewer than four participants; use a pilot with at least four");
  std::vector<double> log_a, b;
  for (const auto& curve : without_one) {
    log_a.push_back(curve.log_a);
    b.push_back(curve.b);
  }
  CurveSpread out;
  out.curve = estimate;
  out.var_log_a = jackknife_covariance(log_a, log_a);
  out.cov = jackknife_covariance(log_a, b);
  out.var_b = jackknife_covariance(b, b);
  out.participants = static_cast<int>(without_one.size());
  out.confidence = confidence;
  out.a_ci = out.band(0).pointwise;
  const double reach = student_quantile(0.5 + confidence / 2, out.participants - 1) * out.b_se();
  out.b_ci = {estimate.b - reach, estimate.b + reach};
  return out;
}

}  // namespace stats
