#include "apps/common/headset/rate_meter.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace apps {

namespace {

constexpr std::int64_t unsettled_steps = 8;
constexpr std::size_t window = 16;
constexpr double same_rate = 0.02;  // share of a period by which measured periods of one rate differ
constexpr double on_grid = 0.1;     // periods

std::int64_t median(std::vector<std::int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rate_of(std::int64_t period_ns) { return 1e9 / static_cast<double>(period_ns); }

}  // namespace

void RateMeter::count(std::int64_t step_ns) {
  const double periods = static_cast<double>(step_ns) / static_cast<double>(period_ns_);
  const double whole = std::max(1.0, std::round(periods));
  dropped_ += static_cast<std::int64_t>(whole) - 1;
  if (std::abs(periods - whole) > on_grid) ++off_grid_;
}

std::optional<RateChange> RateMeter::add(std::int64_t predicted_ns) {
  const std::optional<std::int64_t> before = std::exchange(last_ns_, predicted_ns);
  if (!before) return {};
  const std::int64_t step_ns = predicted_ns - *before;
  if (step_ns <= 0) ++repeated_;
  if (++steps_ <= unsettled_steps || step_ns <= 0) return {};
  latest_.push_back(step_ns);
  if (latest_.size() > window) latest_.pop_front();
  if (period_ns_ != 0) count(step_ns);
  if (latest_.size() < window) return {};
  const std::int64_t now_ns = median({latest_.begin(), latest_.end()});
  const std::int64_t was_ns = period_ns_;
  const double moved = std::abs(static_cast<double>(now_ns - was_ns));
  if (was_ns != 0 && moved <= same_rate * static_cast<double>(was_ns)) return {};
  period_ns_ = now_ns;
  if (was_ns == 0) return {};
  return RateChange{rate_of(was_ns), rate_of(now_ns)};
}

std::optional<double> RateMeter::hz() const {
  if (period_ns_ == 0) return {};
  return rate_of(period_ns_);
}

}  // namespace apps
