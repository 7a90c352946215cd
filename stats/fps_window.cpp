#include "stats/fps_window.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

namespace stats {

namespace {
void check(double interval_s) {
  if (!(interval_s > 0) || !std::isfinite(interval_s)) {
    throw std::invalid_argument(
        "frame rate: a frame interval is not positive and finite; give seconds above 0");
  }
}
}  // namespace

FpsMoments fps_moments(std::span<const double> intervals_s) {
  FpsMoments out;
  out.frames = intervals_s.size();
  if (intervals_s.empty()) return out;
  long double time = 0;
  long double rate_sum = 0;
  for (const double dt : intervals_s) {
    check(dt);
    time += dt;
    rate_sum += 1.0L / dt;
  }
  const auto n = static_cast<long double>(intervals_s.size());
  const long double mean_rate = rate_sum / n;
  long double squares = 0;
  for (const double dt : intervals_s) {
    const long double deviation = 1.0L / dt - mean_rate;
    squares += deviation * deviation;
  }
  out.mean = static_cast<double>(n / time);
  out.mean_arithmetic = static_cast<double>(mean_rate);
  out.sd = static_cast<double>(std::sqrt(squares / n));
  return out;
}

FpsWindow::FpsWindow(std::size_t capacity) : capacity_(capacity) {
  if (capacity == 0)
    throw std::invalid_argument("FpsWindow: the capacity is 0; give room for at least one frame");
}

void FpsWindow::push(double interval_s) {
  check(interval_s);
  intervals_s_.push_back(interval_s);
  if (intervals_s_.size() > capacity_) intervals_s_.pop_front();
}

FpsMoments FpsWindow::moments() const {
  const std::vector<double> intervals(intervals_s_.begin(), intervals_s_.end());
  return fps_moments(intervals);
}

}  // namespace stats
