#include "libstudy/pacing/truncated_normal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace study {

namespace {

constexpr double tail_from = 8;

double upper_tail(double t) { return 0.5 * std::erfc(t / std::numbers::sqrt2); }

/// Mills' ratio Q(t) / phi(t) for t >= tail_from by Laplace's continued fraction. Q: upper tail of the
/// standard normal; phi: its density.
double mills_tail(double t) {
  double fraction = t;
  for (int k = 24; k >= 1; --k) fraction = t + k / fraction;
  return 1 / fraction;
}

double log_upper_tail(double t) { return t < 0 ? std::log1p(-upper_tail(-t)) : std::log(upper_tail(t)); }

/// log(Q(cut + y) / Q(cut)) for y >= 0; Q: upper tail of the standard normal.
double log_survival(double cut, double y) {
  if (cut < tail_from) {
    const double t = cut + y;
    if (t < 30) return log_upper_tail(t) - log_upper_tail(cut);
    const double log_phi = -0.5 * t * t - 0.5 * std::log(2 * std::numbers::pi);
    return log_phi + std::log(mills_tail(t)) - log_upper_tail(cut);
  }
  return -y * (cut + 0.5 * y) + std::log(mills_tail(cut + y) / mills_tail(cut));
}

/// Hazard rate phi(t) / Q(t) of the standard normal: density by upper tail.
double hazard(double t) {
  if (t >= tail_from) return 1 / mills_tail(t);
  return std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi) / upper_tail(t);
}

/// Solves log_survival(cut, y) = target for y; target < 0. The log of the upper tail is concave, so Newton's
/// method converges monotonically from the right after its first step.
double quantile(double cut, double target, double guess) {
  double y = guess;
  for (int i = 0; i < 200; ++i) {
    const double step = (log_survival(cut, y) - target) / hazard(cut + y);
    const double next = std::max(y + step, 0.0);
    const bool settled = std::abs(next - y) <= 1e-14 * next;
    y = next;
    if (settled) break;
  }
  return y;
}

}  // namespace

std::vector<double> truncated_normal_strata(double cut, double width, std::size_t n) {
  // If the middle of the interval is below 0, reflects the interval: the formulas are accurate in the upper
  // tail.
  const bool reflected = std::isfinite(width) && 2 * cut + width < 0;
  const double from = reflected ? -(cut + width) : cut;
  const double lost = std::isfinite(width) ? -std::expm1(log_survival(from, width)) : 1;
  std::vector<double> strata(n);
  // The first search starts where the hazard is not near 0, which keeps its first Newton step finite. Each
  // later search starts from the previous quantile.
  double y = std::max(0.0, -from);
  for (std::size_t i = 0; i < n; ++i) {
    const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    strata[i] = y = quantile(from, std::log1p(-p * lost), y);
  }
  if (reflected) {
    for (double& distance : strata) distance = width - distance;
    std::reverse(strata.begin(), strata.end());
  }
  return strata;
}

}  // namespace study
