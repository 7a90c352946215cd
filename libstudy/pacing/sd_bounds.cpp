#include <algorithm>
#include <cmath>
#include <functional>

#include "libstudy/pacing/hold_search.hpp"

namespace study {

namespace {

/// Calls f(fast rate, slow rate, weight of the fast one) for every pair of holds that can have the target
/// mean.
void for_each_pair(const HoldTarget& target, const std::function<void(double, double, double)>& f) {
  const auto value = [&](int hold) {  // the quantity whose average gives the mean
    return target.mean_kind == FpsMean::Harmonic ? static_cast<double>(hold) : target.refresh_hz / hold;
  };
  const double wished = target.mean_kind == FpsMean::Harmonic ? target.refresh_hz / target.mean : target.mean;
  const double slack = 1e-12 * wished;
  for (int fast = target.shortest; fast <= target.longest; ++fast) {
    for (int slow = fast; slow <= target.longest; ++slow) {
      const double a = value(fast), b = value(slow);
      if (wished < std::min(a, b) - slack || wished > std::max(a, b) + slack) continue;
      const double weight = a == b ? 1 : std::clamp((wished - b) / (a - b), 0.0, 1.0);
      f(target.refresh_hz / fast, target.refresh_hz / slow, weight);
    }
  }
}

/// Largest E (f - c)^2 over all pairs: an upper bound on the variance for every c.
double largest_square(const HoldTarget& target, double c) {
  double largest = 0;
  for_each_pair(target, [&](double fast, double slow, double weight) {
    largest = std::max(largest, weight * (fast - c) * (fast - c) + (1 - weight) * (slow - c) * (slow - c));
  });
  return largest;
}

}  // namespace

SdBounds sd_bounds(const HoldTarget& target) {
  SdBounds bounds;
  double least = HUGE_VAL;
  for_each_pair(target, [&](double fast, double slow, double weight) {
    least = std::min(least, std::sqrt(weight * (1 - weight)) * (fast - slow));
  });
  if (!std::isfinite(least)) return bounds;
  bounds.low = least;
  // Convex in c: a maximum of parabolas.
  double left = target.refresh_hz / target.longest, right = target.refresh_hz / target.shortest;
  for (int i = 0; i < 100 && right - left > 1e-9 * right; ++i) {
    const double a = left + (right - left) / 3, b = right - (right - left) / 3;
    if (largest_square(target, a) < largest_square(target, b))
      right = b;
    else
      left = a;
  }
  bounds.high = std::sqrt(largest_square(target, 0.5 * (left + right)));
  return bounds;
}

}  // namespace study
