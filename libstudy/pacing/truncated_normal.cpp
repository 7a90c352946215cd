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

/// The standard normal above a cut. Q: its upper tail; phi: its density.
class UpperTail {
 public:
  struct Values {
    double log_survival = 0;  ///< log(Q(cut + y) / Q(cut))
    double hazard = 0;        ///< phi(t) / Q(t) at t = cut + y
  };

  explicit UpperTail(double cut)
      : cut_(cut), at_cut_(cut < tail_from ? log_upper_tail(cut) : mills_tail(cut)) {}

  /// y >= 0.
  Values at(double y) const {
    const double t = cut_ + y;
    if (t >= tail_from) {
      const double mills = mills_tail(t);
      if (cut_ >= tail_from) return {-y * (cut_ + 0.5 * y) + std::log(mills / at_cut_), 1 / mills};
      if (t < 30) return {log_upper_tail(t) - at_cut_, 1 / mills};
      const double log_phi = -0.5 * t * t - 0.5 * std::log(2 * std::numbers::pi);
      return {log_phi + std::log(mills) - at_cut_, 1 / mills};
    }
    const double tail = upper_tail(t);
    const double log_tail = t < 0 ? log_upper_tail(t) : std::log(tail);
    return {log_tail - at_cut_, std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi) / tail};
  }

 private:
  double cut_;
  double at_cut_;  ///< log Q(cut) below tail_from, else Mills' ratio at the cut
};

/// Solves log_survival = target for y; target < 0. The log of the upper tail is concave, so Newton's method
/// converges monotonically from the right after its first step.
double quantile(const UpperTail& tail, double target, double guess) {
  double y = guess;
  for (int i = 0; i < 200; ++i) {
    const UpperTail::Values at = tail.at(y);
    const double step = (at.log_survival - target) / at.hazard;
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
  const UpperTail tail(from);
  const double lost = std::isfinite(width) ? -std::expm1(tail.at(width).log_survival) : 1;
  std::vector<double> strata(n);
  // The first search starts where the hazard is not near 0, which keeps its first Newton step finite. Each
  // later search starts from the previous quantile.
  double y = std::max(0.0, -from);
  for (std::size_t i = 0; i < n; ++i) {
    const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    strata[i] = y = quantile(tail, std::log1p(-p * lost), y);
  }
  if (reflected) {
    for (double& distance : strata) distance = width - distance;
    std::reverse(strata.begin(), strata.end());
  }
  return strata;
}

}  // namespace study
