#pragma once
/// A simulated display with the light patch and a sensor on it, whose lag, jitter, drift and losses are
/// known.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/light/light_fit.hpp"

namespace study::test {

/// Showings of `frames` frames with about the rate of each setting in turn: at every third the intervals are
/// equal. 3 to 5 s of black and pages between. grid_ns: all intervals are multiples of it.
inline std::vector<RecordedShowing> light_showings(int count, int frames, unsigned seed = 1,
                                                   std::int64_t grid_ns = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<RecordedShowing> all;
  std::int64_t now_ns = 5'000'000'000'000;
  for (int i = 0; i < count; ++i) {
    RecordedShowing& showing = all.emplace_back();
    showing.presentation = i + 1;
    const double mean_s = 1.0 / (20 + 20 * (i % 3)), spread = i % 3 == 0 ? 0 : 0.3;
    for (int k = 0; k < frames; ++k) {
      showing.onsets_ns.push_back(now_ns);
      now_ns += grid_ns * std::llround(1e9 * mean_s * (1 + spread * (2 * uniform(random) - 1)) /
                                       static_cast<double>(grid_ns));
    }
    now_ns += 3'000'000'000 + std::llround(2e9 * uniform(random));
  }
  return all;
}

struct LightWorld {
  double rate_hz = 1000, drift_ppm = 0, lag_ms = 20, jitter_ms = 0, noise = 0;  ///< noise: of the step
  double lead_s = 2, tail_s = 2;         ///< the log begins and ends this long before and after the showings
  double dark_late_ms = 0;               ///< dark onsets come later than bright ones
  double strobe_hz = 0;                  ///< bright frames are pulses of 2 ms at this rate; 0: steady
  std::map<int, double> more_lag_ms;     ///< by showing, from 0
  std::set<std::pair<int, int>> missed;  ///< showing and frame
  std::vector<double> flashes_s;         ///< pulses of 5 ms at these times after the first onset
  std::vector<std::int64_t> triggers_ns = {};  ///< pulses of 10 ms on the trigger line, record's clock
  unsigned seed = 2;
};

/// The log of a sensor that integrates over its sampling interval: levels 100 and 900, as an Arduino's.
inline SensorLog light_log(const std::vector<RecordedShowing>& showings, const LightWorld& world) {
  std::mt19937 random(world.seed);
  std::normal_distribution<double> normal(0, 1);
  const std::int64_t zero_ns = showings.front().onsets_ns.front();
  const double scale = 1 + 1e-6 * world.drift_ppm;
  const auto sensor_s = [&](std::int64_t ns) {
    return world.lead_s + scale * 1e-9 * static_cast<double>(ns - zero_ns);
  };
  std::vector<std::pair<double, double>> bright;  // from, to
  double end_s = 0;
  for (std::size_t i = 0; i < showings.size(); ++i) {
    const auto& onsets = showings[i].onsets_ns;
    const auto more = world.more_lag_ms.find(static_cast<int>(i));
    const double lag_s = 1e-3 * (world.lag_ms + (more == world.more_lag_ms.end() ? 0 : more->second));
    bool lit = false;
    for (std::size_t k = 0; k <= onsets.size(); ++k) {
      const bool last = k == onsets.size();
      if (!last && world.missed.count({static_cast<int>(i), static_cast<int>(k)})) continue;
      const bool wanted = !last && k % 2 == 0;
      if (wanted == lit) continue;
      const std::int64_t at_ns = last ? 2 * onsets[k - 1] - onsets[k - 2] : onsets[k];
      const double s = sensor_s(at_ns) + lag_s + 1e-3 * world.jitter_ms * normal(random) +
                       (wanted ? 0 : 1e-3 * world.dark_late_ms);
      if (wanted)
        bright.emplace_back(s, s);
      else
        bright.back().second = std::max(s, bright.back().first);
      lit = wanted;
    }
    end_s = sensor_s(onsets.back()) + world.tail_s;
  }
  if (world.strobe_hz > 0) {
    std::vector<std::pair<double, double>> pulses;
    for (const auto& [from, to] : bright)
      for (double s = from; s < to - 1e-3; s += 1 / world.strobe_hz) pulses.emplace_back(s, s + 2e-3);
    bright = pulses;
  }
  for (const double s : world.flashes_s) bright.emplace_back(world.lead_s + s, world.lead_s + s + 5e-3);
  std::sort(bright.begin(), bright.end());
  SensorLog log;
  log.interval_s = 1 / world.rate_hz;
  const auto samples = static_cast<std::size_t>(std::max(0.0, end_s * world.rate_hz));
  std::vector<double> lit(samples + 2);
  const auto add = [&](double from, double to) {
    for (double i = std::floor(from * world.rate_hz); i < to * world.rate_hz; ++i) {
      if (i < 0 || i >= static_cast<double>(samples)) continue;
      lit[static_cast<std::size_t>(i)] +=
          std::min(to * world.rate_hz, i + 1) - std::max(from * world.rate_hz, i);
    }
  };
  for (const auto& [from, to] : bright) add(from, to);
  for (std::size_t i = 0; i < samples; ++i) {
    log.time_s.push_back((static_cast<double>(i) + 0.5) / world.rate_hz);
    log.level.push_back(
        static_cast<float>(100 + 800 * (std::min(1.0, lit[i]) + world.noise * normal(random))));
    if (world.triggers_ns.empty()) continue;
    const double now = log.time_s.back();
    const bool high = std::any_of(world.triggers_ns.begin(), world.triggers_ns.end(), [&](std::int64_t ns) {
      return now >= sensor_s(ns) && now < sensor_s(ns) + 0.01;
    });
    log.trigger.push_back(high ? 5.0f : 0.0f);
  }
  return log;
}

inline std::string light_csv(const SensorLog& log, double unit_s = 1e-3) {
  std::string text;
  for (std::size_t i = 0; i < log.time_s.size(); ++i) {
    text += fmt::format("{:.3f},{:.0f}", log.time_s[i] / unit_s, log.level[i]);
    if (!log.trigger.empty()) text += fmt::format(",{:.0f}", log.trigger[i]);
    text += '\n';
  }
  return text;
}

inline std::optional<LightFit> fit_of(const SensorLog& log, const std::vector<RecordedShowing>& showings,
                                      const std::vector<std::int64_t>& markers_ns, std::string& why,
                                      double hold_s = 0) {
  const auto edges = find_edges(log, log.level, find_levels(log.level, "log", "the level"), hold_s);
  std::vector<LightEdge> triggers;
  if (!log.trigger.empty())
    triggers = find_edges(log, log.trigger, find_levels(log.trigger, "log", "the trigger", 0), 0);
  return fit_light(log, edges, showings, triggers, markers_ns, why);
}

}  // namespace study::test
