#include "libstudy/headset/rate_meter.hpp"

#include <algorithm>
#include <cmath>
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

bool is_whole(std::int64_t step_ns, double unit_ns) {
  const double beside = static_cast<double>(step_ns) / unit_ns - whole_periods(step_ns, unit_ns);
  return std::abs(beside) <= multiple;
}

bool same(double a_ns, double b_ns) { return std::abs(a_ns - b_ns) <= same_rate_share * b_ns; }

}  // namespace

/// The mean period if each step is counted in `unit_ns`; none if less than `share` of the steps are whole
/// multiples of it, within jitter.
std::optional<double> RateMeter::period_in(double unit_ns, double share) const {
  std::int64_t sum_ns = 0;
  double periods = 0, whole = 0;
  for (const Step& step : latest_) {
    sum_ns += step.ns;
    periods += whole_periods(step.ns, unit_ns);
    whole += is_whole(step.ns, unit_ns) ? 1 : 0;
  }
  if (whole < share * static_cast<double>(latest_.size())) return {};
  return static_cast<double>(sum_ns) / periods;
}

/// The period in units of the shortest step of which at least 70 % of the steps are whole multiples, or of
/// the median without such a step. The most frequent step would be wrong: it has several periods if the
/// runtime leaves many slots out.
double RateMeter::period_of_latest() const {
  std::vector<double> steps_ns;
  for (const Step& step : latest_) steps_ns.push_back(static_cast<double>(step.ns));
  std::sort(steps_ns.begin(), steps_ns.end());
  for (const double candidate_ns : steps_ns) {
    if (const auto period_ns = period_in(candidate_ns, most)) return *period_ns;
  }
  return *period_in(steps_ns[steps_ns.size() / 2], 0);
}

/// True if the latest steps have this period, or are multiples of it because slots were left out.
bool RateMeter::fits(double period_ns) const {
  const auto in_unit_ns = period_in(period_ns, most);
  return (in_unit_ns && same(*in_unit_ns, period_ns)) || same(period_of_latest(), period_ns);
}

void RateMeter::report(double hz) {
  misfits_ = 0;
  const double before_ns = std::exchange(reported_ns_, 1e9 / hz);
  if (before_ns == reported_ns_) return;
  forget_latest();
  steps_ = 0;  // some more slots may come at the rate before
}

void RateMeter::doubt() {
  misfits_ = 0;
  if (period_ns_ == 0) reported_ns_ = 0;
}

/// Removes the latest steps and their counts, because they refer to the old rate. Call it when the rate
/// changes.
void RateMeter::forget_latest() {
  for (const Step& step : latest_) {
    dropped_ -= step.dropped;
    off_grid_ -= step.off_grid;
  }
  period_ns_ = 0;
  latest_.clear();
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

void RateMeter::settle_at(double period_ns) {
  period_ns_ = period_ns;
  counted_ns_ = counted_periods_ = 0;
  for (Step& step : latest_) count(step);
}

std::optional<RateChange> RateMeter::settle() {
  if (reported_ns_ != 0) {
    const bool fit = fits(reported_ns_);
    misfits_ = fit ? 0 : misfits_ + 1;
    if (fit && period_ns_ == 0) settle_at(before_ns_ = *period_in(reported_ns_, 0));
    return {};
  }
  if (period_ns_ != 0) {
    // The window mixes steps of the old and the new rate: the new rate is reported once it has settled.
    if (!fits(period_ns_)) forget_latest();
    return {};
  }
  settle_at(period_of_latest());
  const double before_ns = std::exchange(before_ns_, period_ns_);
  if (before_ns == 0 || same(period_ns_, before_ns)) return {};
  return RateChange{1e9 / before_ns, 1e9 / period_ns_};
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
