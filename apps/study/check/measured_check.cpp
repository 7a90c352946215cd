#include "apps/study/check/measured_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace apps {

namespace {

/// Of the refresh: a method this near to it shows what the display shows.
constexpr double at_refresh = 0.98;

std::string format(const char* pattern, double a, double b) {
  char out[160];
  std::snprintf(out, sizeof out, pattern, a, b);
  return out;
}

/// The highest mean rate that cells of this stimulus ask for; 0 under Native.
double asked_fps(const study::Protocol& protocol, const study::StimulusSpec& what) {
  double fps = 0;
  for (const auto& cell : protocol.design.cells) {
    if (cell.stimulus == what) fps = std::max(fps, cell.setting.mean);
  }
  return fps;
}

/// Least tau over windows of 30 frames, as the solver sees it.
double least_tau(const std::vector<double>& intervals_s) {
  stats::FpsWindow window;
  double least = HUGE_VAL;
  for (const double interval : intervals_s) {
    window.push(interval);
    const auto moments = window.moments();
    least = std::min(least, stats::ptpe_tolerance({}, moments));
  }
  return least;
}

MeasuredVerdict judge(const study::Protocol& protocol, const MeasuredStimulus& measured, double refresh_hz) {
  MeasuredVerdict out;
  out.what = measured.what;
  std::vector<double> shown_s, sorted = measured.frame_s;
  for (const double s : measured.frame_s) shown_s.push_back(std::max(s, 1 / refresh_hz));
  out.fps = stats::fps_moments(shown_s);
  out.tau_min = least_tau(shown_s);
  std::sort(sorted.begin(), sorted.end());
  out.p95_ms = 1000 * sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  const double asked = asked_fps(protocol, measured.what);
  const double alone = stats::fps_moments(measured.frame_s).mean;
  if (asked > 0 && alone < asked) {
    out.too_slow = true;
    out.words = format("too slow live: %.3g frames/s where %.4g are asked for", alone, asked);
  } else if (asked == 0 && alone < protocol.pacing.fps_min) {
    out.too_slow = true;
    out.words = format("too slow live: %.3g frames/s, below fps_min = %.4g", alone, protocol.pacing.fps_min);
  } else if (asked > 0 && out.p95_ms > 1000 / asked) {
    out.words = format("some frames late: 5 %% take over %.1f ms, the mean interval is %.1f ms", out.p95_ms,
                       1000 / asked);
  }
  return out;
}

std::string collapse_of(const std::vector<MeasuredStimulus>& measured,
                        const std::vector<MeasuredVerdict>& verdicts, double refresh_hz) {
  std::map<std::pair<std::string, std::string>, bool> all_reach;  // by scene and n_*
  bool temporal = false, accelerates = false;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto& what = measured[i].what;
    const bool reaches = verdicts[i].fps.mean >= at_refresh * refresh_hz;
    auto& all = all_reach.try_emplace({what.scene, what.n_star}, true).first->second;
    all = all && reaches;
    temporal = temporal || measured[i].temporal;
    accelerates = accelerates || (measured[i].temporal && verdicts[i].tau_min < 0);
  }
  const bool reach =
      std::all_of(all_reach.begin(), all_reach.end(), [](const auto& one) { return one.second; });
  if (reach) return format("every method reaches the %g Hz of the display", refresh_hz, 0);
  if (temporal && !accelerates) return "tau of the accelerated methods never falls below zero";
  return {};
}

}  // namespace

std::vector<study::StimulusSpec> stimuli_of(const study::Protocol& protocol) {
  std::vector<study::StimulusSpec> out;
  for (const auto& cell : protocol.design.cells) {
    if (std::find(out.begin(), out.end(), cell.stimulus) == out.end()) out.push_back(cell.stimulus);
  }
  return out;
}

MeasuredReport judge_measured(const study::Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz) {
  MeasuredReport out;
  for (const auto& one : measured) out.stimuli.push_back(judge(protocol, one, refresh_hz));
  out.too_slow =
      std::any_of(out.stimuli.begin(), out.stimuli.end(), [](const auto& one) { return one.too_slow; });
  if (protocol.design.timing == study::TimingSource::Native)
    out.collapse = collapse_of(measured, out.stimuli, refresh_hz);
  return out;
}

}  // namespace apps
