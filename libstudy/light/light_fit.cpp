#include "libstudy/light/light_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libstudy/light/clock_fit.hpp"

namespace study {

namespace {

constexpr double least_trigger_share = 0.6;

/// Compares a showing with the edges. residuals: of its matched onsets, s.
ShowingLight compare_light(const std::vector<double>& t, const ClockMapping& mapping,
                           std::span<const LightEdge> edges, std::vector<double>& residuals) {
  const std::size_t count = t.size();
  const auto place = [&](std::size_t k) { return mapping.at(t[k], k % 2 == 0); };
  const auto after = [&](double time_s) {
    return static_cast<std::size_t>(
        std::lower_bound(edges.begin(), edges.end(), time_s,
                         [](const LightEdge& edge, double value) { return edge.time_s < value; }) -
        edges.begin());
  };
  ShowingLight light;
  light.frames = static_cast<std::int64_t>(count);
  std::size_t next = after(place(0) - 0.5 * (t[1] - t[0]));
  for (std::size_t k = 0; k < count; ++k) {
    const bool rise = k % 2 == 0;
    const double before_s = k > 0 ? t[k] - t[k - 1] : t[1] - t[0];
    const double interval_s = k + 1 < count ? t[k + 1] - t[k] : before_s;
    std::size_t found = edges.size();
    for (std::size_t e = next; e < edges.size() && edges[e].time_s <= place(k) + 0.9 * interval_s; ++e) {
      const double away = std::abs(edges[e].time_s - place(k));
      if (edges[e].rise != rise || edges[e].time_s <= place(k) - 0.5 * before_s) continue;
      if (found == edges.size() || away < std::abs(edges[found].time_s - place(k))) found = e;
    }
    if (found < edges.size()) {
      light.extra += static_cast<std::int64_t>(found - next);
      next = found + 1;
      residuals.push_back(edges[found].time_s - place(k));
      continue;
    }
    const std::size_t past = after(place(k) + 0.25 * interval_s);
    const bool bright = past > 0 ? edges[past - 1].rise : !edges.front().rise;
    if (bright == rise)
      ++light.hidden;
    else
      light.missed.push_back(static_cast<std::int64_t>(k));
  }
  const std::size_t last = after(place(count - 1) + 0.5 * (t[count - 1] - t[count - 2]));
  light.extra += static_cast<std::int64_t>(std::max(last, next) - next);
  light.matched = static_cast<std::int64_t>(residuals.size());
  return light;
}

/// Sets lag, jitter and worst deviation.
void describe_lag(ShowingLight& light, const std::vector<double>& residuals) {
  if (residuals.empty()) return;
  const double lag_s = trimmed_light_mean(residuals);
  const double mean_s =
      std::accumulate(residuals.begin(), residuals.end(), 0.0) / static_cast<double>(residuals.size());
  double squares = 0, worst = 0;
  for (const double one : residuals) {
    squares += (one - mean_s) * (one - mean_s);
    worst = std::max(worst, std::abs(one - lag_s));
  }
  light.lag_ms = 1e3 * lag_s;
  light.worst_ms = 1e3 * worst;
  if (residuals.size() > 1)
    light.jitter_ms = 1e3 * std::sqrt(squares / static_cast<double>(residuals.size() - 1));
}

/// The common time from a marker's trigger to the place where the mapping puts the marker, s, with the
/// number of markers that have it. None if fewer than 60 % of the markers within the log have a trigger
/// there.
std::optional<std::pair<double, std::int64_t>> trigger_lag(const std::vector<double>& places_s,
                                                           std::span<const LightEdge> triggers,
                                                           const SensorLog& log) {
  constexpr double earliest_s = -0.05, latest_s = 0.25, window_s = 1e-3;
  std::vector<double> lags;
  std::int64_t inside = 0;
  for (const double place : places_s) {
    inside += place > log.time_s.front() + latest_s && place < log.time_s.back() + earliest_s;
    for (const LightEdge& trigger : triggers)
      if (trigger.rise && place - trigger.time_s > earliest_s && place - trigger.time_s < latest_s)
        lags.push_back(place - trigger.time_s);
  }
  std::sort(lags.begin(), lags.end());
  std::size_t first = 0, best_first = 0, best = 0;
  for (std::size_t last = 0; last < lags.size(); ++last) {
    while (lags[last] - lags[first] > 2 * window_s) ++first;
    if (last - first + 1 <= best) continue;
    best = last - first + 1;
    best_first = first;
  }
  if (best == 0 || static_cast<double>(best) < least_trigger_share * static_cast<double>(inside)) return {};
  const auto begin = lags.begin() + static_cast<std::ptrdiff_t>(best_first);
  return std::pair{trimmed_light_mean({begin, begin + static_cast<std::ptrdiff_t>(best)}),
                   static_cast<std::int64_t>(best)};
}

}  // namespace

std::optional<LightFit> fit_light(const SensorLog& log, std::span<const LightEdge> edges,
                                  std::span<const RecordedShowing> showings,
                                  std::span<const LightEdge> triggers,
                                  std::span<const std::int64_t> markers_ns, std::string& why) {
  std::vector<RecordedShowing> whole;
  for (const RecordedShowing& showing : showings)
    if (showing.onsets_ns.size() >= 2) whole.push_back(showing);
  if (whole.empty() || edges.empty()) {
    why = whole.empty() ? "has no showing of two frames" : "has no change of light in the log";
    return {};
  }
  const std::int64_t zero_ns = whole.front().onsets_ns.front();
  const auto seconds = [&](std::int64_t ns) { return 1e-9 * static_cast<double>(ns - zero_ns); };
  OnsetTimes onsets_s;
  for (const RecordedShowing& showing : whole) {
    auto& times = onsets_s.emplace_back();
    for (const std::int64_t ns : showing.onsets_ns) times.push_back(seconds(ns));
  }
  const auto found = align_clocks(log, edges, onsets_s);
  if (!found || 2 * found->agreeing < found->inside) {
    why = found && found->inside > 0
              ? fmt::format("only {} of the {} showings that would lie in the log fit it", found->agreeing,
                            found->inside)
              : "no showing fits the changes of light in the log";
    return {};
  }
  LightFit fit;
  fit.drift_ppm = 1e6 * (found->mapping.scale - 1);
  fit.fall_shift_ms = 1e3 * found->mapping.shift;
  std::vector<double> lags;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<double> residuals;
    ShowingLight light;
    light.unjudged = why_unjudged(onsets_s[i], found->mapping, log);
    if (light.unjudged.empty()) {
      light = compare_light(onsets_s[i], found->mapping, edges, residuals);
      describe_lag(light, residuals);
      ++fit.judged;
      if (light.matched > 0) lags.push_back(light.lag_ms);
    }
    light.frames = static_cast<std::int64_t>(onsets_s[i].size());
    light.presentation = whole[i].presentation;
    fit.showings.push_back(std::move(light));
  }
  double zero_ms = light_median(lags);
  std::vector<double> places_s;
  for (const std::int64_t ns : markers_ns) places_s.push_back(found->mapping.at(seconds(ns), true));
  if (const auto lag = trigger_lag(places_s, triggers, log)) {
    fit.absolute = true;
    fit.triggers = lag->second;
    zero_ms = -1e3 * lag->first;
  }
  for (ShowingLight& light : fit.showings) light.lag_ms -= zero_ms;
  return fit;
}

std::optional<TimingGrade> light_grade(const ShowingLight& light, double interval_s, std::string& why) {
  why = light.unjudged;
  if (!why.empty()) return {};
  const auto add = [&](const std::string& reason) { why += (why.empty() ? "" : "; ") + reason; };
  if (light.frames < least_graded_frames) add(fmt::format("has fewer than {} frames", least_graded_frames));
  if (!light.missed.empty()) add(fmt::format("{} frames missed", light.missed.size()));
  if (light.hidden > 0) add(fmt::format("{} onsets hidden by them", light.hidden));
  if (light.extra > 0) add(fmt::format("{} changes of light without a frame", light.extra));
  const bool complete = why.empty();
  for (const LightBounds& bounds : light_bounds) {
    const auto exceeds = [&](double value, double bound, const char* what) {
      if (value > bound && (complete || bounds.grade == TimingGrade::Photodiode))
        add(fmt::format("{} {:.3g} ms (bound {:.3g} ms)", what, value, bound));
      return value > bound;
    };
    bool within = !exceeds(1e3 * interval_s, bounds.interval_ms, "samples every");
    within &= !exceeds(light.jitter_ms, bounds.jitter_ms, "jitter");
    within &= !exceeds(light.worst_ms, bounds.worst_ms, "an onset is off by");
    if (complete && within) return bounds.grade;
  }
  return {};
}

}  // namespace study
