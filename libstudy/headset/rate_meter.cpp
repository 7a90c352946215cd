#include "libstudy/headset/rate_meter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace study {

namespace {

constexpr int first_steps = 8;
constexpr std::size_t window = 16;
constexpr double multiple = 0.2;  // largest deviation from a whole number, periods
constexpr double most = 0.7;
constexpr double same_rate_share = 0.04;  // largest relative difference of equal rates
constexpr double on_grid = 0.1;           // largest deviation of a step that counts as whole, periods

double whole_periods(std::int64_t step_ns, double period_ns) {
  return std::max(1.0, std::round(static_cast<double>(step_ns) / period_ns));
}

/// The shortest step of which at least 70 % of the steps are whole multiples, within jitter; the median
/// without such a step. The most frequent step would be wrong: it has several periods if the runtime leaves
/// many slots out.
std::int64_t typical_step(std::vector<std::int64_t> steps_ns) {
  std::sort(steps_ns.begin(), steps_ns.end());
  for (const std::int64_t candidate_ns : steps_ns) {
    const auto fits = std::count_if(steps_ns.begin(), steps_ns.end(), [&](std::int64_t step_ns) {
      const auto candidate = static_cast<double>(candidate_ns);
      const double beside = static_cast<double>(step_ns) / candidate - whole_periods(step_ns, candidate);
      return std::abs(beside) <= multiple;
    });
    if (static_cast<double>(fits) >= most * static_cast<double>(steps_ns.size())) return candidate_ns;
  }
  return steps_ns[steps_ns.size() / 2];
}

bool same(double a_ns, double b_ns) { return std::abs(a_ns - b_ns) <= same_rate_share * b_ns; }

}  // namespace

double RateMeter::period_of_latest() const {
  std::vector<std::int64_t> steps_ns;
  for (const Step& step : latest_) steps_ns.push_back(step.ns);
  const auto typical = static_cast<double>(typical_step(steps_ns));
  double periods = 0;
  for (const std::int64_t step_ns : steps_ns) periods += whole_periods(step_ns, typical);
  return static_cast<double>(std::accumulate(steps_ns.begin(), steps_ns.end(), std::int64_t{0})) / periods;
}

void RateMeter::count(Step& step) {
  const double whole = whole_periods(step.ns, period_ns_);
  counted_ns_ += step.ns;
  counted_periods_ += static_cast<std::int64_t>(whole);
  step.dropped = static_cast<std::int64_t>(whole) - 1;
  step.off_grid = std::abs(static_cast<double>(step.ns) / period_ns_ - whole) > on_grid;
  dropped_ += step.dropped;
  off_grid_ += step.off_grid;
}

std::optional<RateChange> RateMeter::settle() {
  const double period_ns = period_of_latest();
  if (period_ns_ != 0) {
    if (same(period_ns, period_ns_)) return {};
    // The window mixes steps of the old and the new rate: the new rate is reported once it has settled.
    // Removes the counts of these steps, because they are relative to the old rate.
    for (const Step& step : latest_) {
      dropped_ -= step.dropped;
      off_grid_ -= step.off_grid;
    }
    period_ns_ = 0;
    latest_.clear();
    return {};
  }
  period_ns_ = period_ns;
  counted_ns_ = counted_periods_ = 0;
  for (Step& step : latest_) count(step);
  const double before_ns = std::exchange(before_ns_, period_ns);
  if (before_ns == 0 || same(period_ns, before_ns)) return {};
  return RateChange{1e9 / before_ns, 1e9 / period_ns};
}

std::optional<RateChange> RateMeter::add(std::int64_t predicted_ns) {
  const std::optional<std::int64_t> before = std::exchange(last_ns_, predicted_ns);
  if (!before) return {};
  const std::int64_t step_ns = predicted_ns - *before;
  repeated_ += step_ns <= 0;
  if (++steps_ <= first_steps || step_ns <= 0) return {};
  if (latest_.size() == window) latest_.erase(latest_.begin());
  latest_.push_back({step_ns});
  if (period_ns_ != 0) count(latest_.back());
  return latest_.size() == window ? settle() : std::nullopt;
}

void RateMeter::interrupt() {
  last_ns_.reset();
  steps_ = 0;
  latest_.clear();
}

std::optional<double> RateMeter::hz() const {
  if (period_ns_ == 0) return {};
  return 1e9 * static_cast<double>(counted_periods_) / static_cast<double>(counted_ns_);
}

}  // namespace study
