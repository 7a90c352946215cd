#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "stats/ptpe/exponential_fit.hpp"
#include "stats/quantiles.hpp"
#include "stats/root.hpp"

namespace stats {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The pairs without NaN. y is divided by its largest magnitude, `unit`.
struct Pairs {
  std::vector<double> x, y, w;
  double unit = 0;
};

Pairs whole_pairs(std::span<const double> x, std::span<const double> y, std::span<const double> weights) {
  Pairs out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = weights.empty() ? 1 : weights[i];
    if (std::isnan(x[i]) || std::isnan(y[i]) || std::isnan(w)) continue;
    out.x.push_back(x[i]);
    out.y.push_back(y[i]);
    out.w.push_back(w);
    out.unit = std::max(out.unit, std::abs(y[i]));
  }
  for (double& v : out.y) v /= out.unit;
  return out;
}

/// Least sum of squares over a for a fixed b. Subtracting `centre` from x keeps exp(b x) within double's
/// range.
double rss_at_b(const Pairs& data, double b, double centre) {
  double num = 0, den = 0, rss = 0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double e = std::exp(b * (data.x[i] - centre));
    num += data.w[i] * data.y[i] * e;
    den += data.w[i] * e * e;
  }
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double r = num / den * std::exp(b * (data.x[i] - centre)) - data.y[i];
    rss += data.w[i] * r * r;
  }
  return rss;
}

/// Least sum of squares over b for a fixed a = sign exp(log_a): Gauss-Newton steps from the given b, each
/// halved until it reduces the sum.
double rss_at_a(const Pairs& data, double sign, double log_a, double b) {
  const auto sums = [&](double rate, double& slope, double& curvature) {
    double rss = 0;
    slope = curvature = 0;
    for (std::size_t i = 0; i < data.x.size(); ++i) {
      const double f = sign * std::exp(log_a + rate * data.x[i]), r = f - data.y[i], d = f * data.x[i];
      rss += data.w[i] * r * r;
      slope += data.w[i] * r * d;
      curvature += data.w[i] * d * d;
    }
    return rss;
  };
  double slope = 0, curvature = 0, rss = sums(b, slope, curvature);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double step = -slope / curvature;
    if (!std::isfinite(step) || std::abs(step) < 1e-14 * (std::abs(b) + 1e-6)) return rss;
    bool moved = false;
    for (double length = 1; length > 1e-10 && !moved; length /= 2) {
      double s = 0, c = 0;
      const double there = sums(b + length * step, s, c);
      if (!(there < rss)) continue;
      b += length * step;
      rss = there;
      slope = s;
      curvature = c;
      moved = true;
    }
    if (!moved) return rss;
  }
  return rss;
}

/// The first zero of `excess` beyond `from`, where `excess` is negative; searched in steps of `stride`.
/// Infinite if 400 steps do not reach it, or if `excess` is not finite before it.
double end_of(const std::function<double(double)>& excess, double from, double stride) {
  double inside = from;
  for (int i = 0; i < 400; ++i) {
    const double outside = inside + stride;
    const double value = excess(outside);
    if (!std::isfinite(value)) break;
    if (value > 0) return find_root(excess, std::min(inside, outside), std::max(inside, outside));
    inside = outside;
  }
  return std::copysign(infinity, stride);
}

}  // namespace

Result<ExponentialProfile> profile_exponential(std::span<const double> x, std::span<const double> y,
                                               std::span<const double> weights, double level) {
  const auto fit = fit_exponential(x, y, weights);
  if (!fit) return Refusal{fit.reason()};
  if (!fit->covariance) return Refusal{"no degree of freedom is left for an interval"};
  const auto data = whole_pairs(x, y, weights);
  const double t = student_quantile(0.5 + level / 2, fit->df());
  const double least = fit->rss / (data.unit * data.unit), limit = least * (1 + t * t / fit->df());
  double total = 0, centre = 0, mass = 0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double f = fit->value(data.x[i]) / data.unit;
    total += data.w[i] * data.y[i] * data.y[i];
    centre += data.w[i] * f * f * data.x[i];
    mass += data.w[i] * f * f;
  }
  if (!(least > 1e-24 * total))
    return Refusal{"the curve goes through every point: nothing is left to profile"};
  centre /= mass;
  ExponentialProfile out;
  const double b_step = std::sqrt(fit->covariance->bb);
  const auto at_b = [&](double b) { return rss_at_b(data, b, centre) - limit; };
  out.b = {end_of(at_b, fit->b, -b_step), end_of(at_b, fit->b, b_step)};
  // Searches over log |a|. For each a, the search for b starts from the b that keeps the curve unchanged at
  // the data's centre, and from the fitted b.
  const double sign = fit->a < 0 ? -1 : 1, log_a = std::log(std::abs(fit->a) / data.unit);
  const double a_step = std::min(1.0, std::sqrt(fit->covariance->aa) / std::abs(fit->a));
  const auto at_a = [&](double value) {
    const double rate = centre == 0 ? fit->b : fit->b - (value - log_a) / centre;
    return std::min(rss_at_a(data, sign, value, rate), rss_at_a(data, sign, value, fit->b)) - limit;
  };
  const double near = sign * std::exp(end_of(at_a, log_a, -a_step)) * data.unit;
  const double far = sign * std::exp(end_of(at_a, log_a, a_step)) * data.unit;
  // If the interval of a has no end between the fitted a and zero, it extends beyond zero without limit.
  const double inner = near == 0 ? -sign * infinity : near;
  out.a = {std::min(inner, far), std::max(inner, far)};
  return out;
}

}  // namespace stats
