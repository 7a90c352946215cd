#include "libstudy/console/refresh.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "libstudy/pacing/nominal_refresh.hpp"

namespace study {

namespace {

constexpr std::size_t fewest_swaps = 20;
constexpr double shortest_ns = 2e6, longest_ns = 50e6;

/// Fraction of the steps that last a whole number of periods, within a tenth of a period.
double share_in_time(const std::vector<double>& steps_ns, double period_ns) {
  std::size_t good = 0;
  for (const double step : steps_ns) {
    const double periods = step / period_ns;
    if (std::round(periods) >= 1 && std::abs(periods - std::round(periods)) < 0.1) ++good;
  }
  return static_cast<double>(good) / static_cast<double>(steps_ns.size());
}

}  // namespace

MeasuredRefresh judge_swaps(std::span<const std::int64_t> returns_ns, double reported_hz) {
  MeasuredRefresh out;
  if (returns_ns.size() < fewest_swaps) {
    out.finding = "too few swaps to measure the refresh";
    return out;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < returns_ns.size(); ++i)
    steps.push_back(static_cast<double>(returns_ns[i] - returns_ns[i - 1]));
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  if (median < shortest_ns || median > longest_ns || share_in_time(steps, median) < 0.9) {
    out.finding =
        fmt::format("swaps do not wait for the screen (median {:.3g} ms); the system reports {:.4g} Hz",
                    1e-6 * median, reported_hz);
    return out;
  }
  double periods = 0, total = 0;
  for (const double step : steps) {
    periods += std::max(1.0, std::round(step / median));
    total += step;
  }
  out.in_effect = true;
  out.period_ns = total / periods;
  const double measured_hz = 1e9 / out.period_ns;
  out.nominal_hz = nominal_refresh(measured_hz, reported_hz);
  out.beat_ns = beat_of(returns_ns.last(10), out.period_ns);
  out.finding = fmt::format("swaps wait for the screen: measured {:.4f} Hz, the system reports {:.4g} Hz",
                            measured_hz, reported_hz);
  return out;
}

std::int64_t beat_of(std::span<const std::int64_t> returns_ns, double period_ns) {
  const std::int64_t last = returns_ns.back();
  std::int64_t beat = last;
  for (const std::int64_t at : returns_ns) {
    const double periods = std::round(static_cast<double>(last - at) / period_ns);
    beat = std::min<std::int64_t>(beat, at + std::llround(periods * period_ns));
  }
  return beat;
}

std::int64_t between_beats(const MeasuredRefresh& refresh, std::int64_t earliest_ns) {
  if (!refresh.in_effect) return earliest_ns;
  const double periods = (static_cast<double>(earliest_ns - refresh.beat_ns)) / refresh.period_ns;
  return refresh.beat_ns + std::llround((std::ceil(periods - 0.5) + 0.5) * refresh.period_ns);
}

std::int64_t next_beat(const MeasuredRefresh& refresh, std::int64_t handed_over_ns) {
  if (!refresh.in_effect) return -1;
  const double periods = static_cast<double>(handed_over_ns - refresh.beat_ns) / refresh.period_ns;
  return refresh.beat_ns + std::llround((std::floor(periods) + 1) * refresh.period_ns);
}

}  // namespace study
