#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/frame_order.hpp"
#include "libstudy/pacing/hold_search.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr double sd_relative = 0.02;
constexpr double sd_absolute = 0.25;  // frames/s
constexpr double approximate_mean = 0.005;
constexpr double arithmetic_mean_met = 1e-4;
constexpr double harmonic_mean_met = 1e-9;
constexpr double exact_interval = 0.01;  // largest change of a pattern's interval, as a share of the interval
constexpr double whole = 1e-6;           // rounding tolerance, periods; in is_whole() a share of the periods

HoldTarget target_for(const FpsSetting& setting, const PacingRules& rules, double refresh_hz) {
  HoldTarget target;
  target.rates = exact_rates(setting, rules);
  std::reverse(target.rates.begin(), target.rates.end());
  target.refresh_hz = refresh_hz;
  target.shortest =
      rules.fps_max ? static_cast<int>(std::max(1.0, std::ceil(refresh_hz / *rules.fps_max - whole))) : 1;
  const double rounded_up = std::ceil(refresh_hz / target.rates.back() - whole);
  const double allowed =
      std::floor(refresh_hz * std::min(1 / rules.fps_min, 1e-3 * rules.max_interval_ms) + whole);
  target.longest = static_cast<int>(std::min(rounded_up, allowed));
  target.mean_kind = rules.mean;
  target.mean = setting.mean;
  target.mean_tolerance =
      setting.mean * (rules.mean == FpsMean::Harmonic ? harmonic_mean_met : arithmetic_mean_met);
  target.sd = setting.sd;
  target.sd_tolerance = std::max(sd_relative * setting.sd, sd_absolute);
  return target;
}

double requested_periods(const HoldTarget& target) {
  return target.refresh_hz * static_cast<double>(target.rates.size()) / target.mean;
}

bool is_whole(double periods) { return std::abs(periods - std::round(periods)) <= whole * periods; }

/// A list of holds (refresh periods of each frame) that meets mean and standard deviation to the tolerances
/// of `target`; its excess is > 0 if no such list was found.
HoldList exact_list(const HoldTarget& target) {
  if (target.mean_kind == FpsMean::Arithmetic) return search_holds(target, 0);
  const double periods = requested_periods(target);
  if (is_whole(periods)) return search_holds(target, std::llround(periods));
  HoldList none;
  none.excess = HUGE_VAL;
  return none;
}

double sd_miss(const HoldList& list, const HoldTarget& target) {
  return std::max(0.0, std::abs(list.sd - target.sd) - target.sd_tolerance);
}

double mean_miss(const HoldList& list, const HoldTarget& target) { return std::abs(list.mean - target.mean); }

/// The best list of holds with a mean within 0.5 % of the target; no holds if there is none. For a harmonic
/// mean it searches every total of periods in this range. Keeps the lists within the tolerance of the
/// standard deviation. If there are none, keeps the lists whose error of the standard deviation exceeds the
/// least such error by at most one tolerance. Of the lists kept, returns the list with the mean nearest to
/// the target.
HoldList approximate_list(HoldTarget target) {
  const double bound = approximate_mean * target.mean;
  std::vector<HoldList> found;
  if (target.mean_kind == FpsMean::Arithmetic) {
    target.mean_tolerance = bound;
    found.push_back(search_holds(target, 0));
  } else {
    const double periods = requested_periods(target);
    const auto first = static_cast<std::int64_t>(std::ceil(periods / (1 + approximate_mean)));
    const auto last = static_cast<std::int64_t>(std::floor(periods / (1 - approximate_mean)));
    target.mean_tolerance = bound;
    for (std::int64_t total = first; total <= last; ++total) found.push_back(search_holds(target, total));
  }
  std::erase_if(found, [&](const HoldList& list) {
    return !std::isfinite(list.excess) || mean_miss(list, target) > bound;
  });
  double least = HUGE_VAL;
  for (const auto& list : found) least = std::min(least, sd_miss(list, target));
  const double equal = least > 0 ? least + target.sd_tolerance : 0;
  HoldList best;
  for (auto& list : found) {
    if (sd_miss(list, target) > equal) continue;
    if (best.holds.empty() || mean_miss(list, target) < mean_miss(best, target)) best = std::move(list);
  }
  return best;
}

/// Why no list with exactly the target mean can have the target standard deviation, in words; empty: no proof
/// of this.
std::string what_bounds_sd(const HoldTarget& target) {
  const auto bounds = sd_bounds(target);
  if (bounds.low > bounds.high)
    return fmt::format("no holds of {} to {} periods have this mean", target.shortest, target.longest);
  if (bounds.low > target.sd + target.sd_tolerance)
    return fmt::format("at exactly the requested mean the refresh forces an sd of {:.4g} or more",
                       bounds.low);
  if (bounds.high < target.sd - target.sd_tolerance)
    return fmt::format(
        "at exactly the requested mean, intervals up to {:.1f} ms allow an sd of {:.4g} at most",
        1e3 * target.longest / target.refresh_hz, bounds.high);
  return {};
}

/// Words that say which moments the list `best` misses, by how much, and why. `tried`: the result of
/// exact_list(), which searches for a list within the tolerances of `target` and found none.
std::string what_misses(const HoldTarget& target, const HoldList& tried, const HoldList& best) {
  std::string words;
  if (best.holds.empty())
    words =
        fmt::format("no list of holds has a mean within {:g} % of {:g}", 100 * approximate_mean, target.mean);
  else if (mean_miss(best, target) > target.mean_tolerance)
    words = fmt::format("mean {:.6g} for {:g} ({:+.2g} %)", best.mean, target.mean,
                        100 * (best.mean / target.mean - 1));
  if (!best.holds.empty() && sd_miss(best, target) > 0)
    words += (words.empty() ? "" : ", ") +
             fmt::format("sd {:.4g} for {:g} ({:.2g} allowed)", best.sd, target.sd, target.sd_tolerance);
  const std::string bound = what_bounds_sd(target);
  if (!bound.empty()) return words + (words.empty() ? "" : ": ") + bound;
  return words.empty() ? fmt::format("no whole hold counts found nearer than sd {:.4g}", tried.sd) : words;
}

void fill(RefreshVerdict& verdict, const HoldList& list, const PacingRules& rules, double refresh_hz,
          std::uint64_t seed) {
  verdict.mean = list.mean;
  verdict.sd = list.sd;
  verdict.distance = list.distance;
  verdict.longest_hold = list.holds.back();
  std::vector<double> rates;
  for (const int hold : list.holds) rates.push_back(refresh_hz / hold);
  for (const double rate : ordered(std::move(rates), rules, seed))
    verdict.holds.push_back(static_cast<int>(std::lround(refresh_hz / rate)));
}

/// Moves each deadline of a pattern to the nearest period, but to at least one period after the deadline
/// before.
RefreshVerdict quantise_pattern(const FpsSetting& setting, double refresh_hz, std::uint64_t seed) {
  RefreshVerdict out;
  const auto wanted_s = pattern_intervals(*setting.profile, setting.duration_s, seed);
  double time_s = 0, worst = 0, distance = 0;
  std::int64_t last = 0;
  std::vector<double> shown_s;
  for (const double interval : wanted_s) {
    time_s += interval;
    const std::int64_t period = std::max<std::int64_t>(last + 1, std::llround(time_s * refresh_hz));
    out.holds.push_back(static_cast<int>(period - last));
    last = period;
    shown_s.push_back(out.holds.back() / refresh_hz);
    worst = std::max(worst, std::abs(shown_s.back() / interval - 1));
    distance += (1 / shown_s.back() - 1 / interval) * (1 / shown_s.back() - 1 / interval);
  }
  const stats::FpsMoments moments = stats::fps_moments(shown_s);
  out.frames = static_cast<std::int64_t>(shown_s.size());
  out.mean = moments.mean;
  out.sd = moments.sd;
  out.distance = std::sqrt(distance / static_cast<double>(shown_s.size()));
  out.longest_hold = *std::max_element(out.holds.begin(), out.holds.end());
  const double wanted_mean = static_cast<double>(shown_s.size()) / time_s;
  const double period_ms = 1e3 / refresh_hz;
  if (worst <= exact_interval) {
    out.feasibility = Feasibility::Exact;
  } else if (std::abs(out.mean / wanted_mean - 1) <= approximate_mean) {
    out.feasibility = Feasibility::Approximate;
    out.reason =
        fmt::format("frames change by up to {:.0f} % to fit periods of {:.4g} ms", 100 * worst, period_ms);
  } else {
    out.reason = fmt::format("periods of {:.4g} ms give a mean of {:.4g} instead of {:.4g} frames/s",
                             period_ms, out.mean, wanted_mean);
    out.holds.clear();
  }
  return out;
}

}  // namespace

RefreshVerdict quantise(const FpsSetting& setting, const PacingRules& requested_rules, double refresh_hz,
                        std::uint64_t seed) {
  if (!(refresh_hz > 0 && std::isfinite(refresh_hz)))
    throw base::Error(fmt::format("refresh {:g} Hz", refresh_hz), "is not a refresh rate",
                      "give the display's refresh rate in hertz, such as 60");
  if (has_pattern(setting)) return quantise_pattern(setting, refresh_hz, seed);
  const auto rules = for_display(requested_rules, refresh_hz);
  RefreshVerdict verdict;
  verdict.frames = frame_count(setting);
  HoldTarget target;
  try {
    target = target_for(setting, rules, refresh_hz);
  } catch (const base::Error& error) {
    const std::string message = error.what();
    verdict.reason = message.substr(0, message.find('\n'));
    return verdict;
  }
  if (target.shortest > target.longest) {
    verdict.reason =
        fmt::format("a frame would have to stay on for at least {} but at most {} refresh periods",
                    target.shortest, target.longest);
    return verdict;
  }
  HoldList list = exact_list(target);
  verdict.feasibility = Feasibility::Exact;
  if (list.excess > 0) {
    const HoldList tried = std::move(list);
    list = approximate_list(target);
    verdict.reason = what_misses(target, tried, list);
    verdict.feasibility = Feasibility::Approximate;
  }
  if (list.holds.empty()) {
    verdict.feasibility = Feasibility::Unreachable;
    return verdict;
  }
  fill(verdict, list, rules, refresh_hz, seed);
  return verdict;
}

Schedule schedule_of_holds(const std::vector<int>& holds, double refresh_hz) {
  Schedule schedule;
  std::int64_t periods = 0, last_ns = 0;
  for (const int hold : holds) {
    periods += hold;
    const std::int64_t deadline_ns = std::llround(1e9 * static_cast<double>(periods) / refresh_hz);
    schedule.intervals_s.push_back(hold / refresh_hz);
    schedule.intervals_ns.push_back(deadline_ns - last_ns);
    last_ns = deadline_ns;
  }
  return schedule;
}

std::string feasibility_name(Feasibility feasibility) {
  switch (feasibility) {
    case Feasibility::Exact:
      return "exact";
    case Feasibility::Approximate:
      return "approximate";
    case Feasibility::Unreachable:
      break;
  }
  return "unreachable";
}

}  // namespace study
