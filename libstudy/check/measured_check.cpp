#include "libstudy/check/measured_check.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "stats/ptpe/ptpe.hpp"

namespace study {

namespace {

/// A cell reaches the display's refresh rate if its mean frame rate is at least this fraction of that rate.
constexpr double at_refresh = 0.98;

/// Smallest tolerance tau over all windows of up to 30 frame intervals, frames/s, with the paper's model
/// tau = mean - a exp(b sd) of a window's frame rates. A method with temporal acceleration accelerates where
/// tau < 0.
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

void judge_rate(MeasuredCell& out, const Protocol& protocol, double alone) {
  const double asked = out.setting.mean;
  if (asked > 0 && alone < asked) {
    out.too_slow = true;
    out.words = fmt::format("too slow live: {:.3g} frames/s where {:.4g} are asked for", alone, asked);
  } else if (asked == 0 && alone < protocol.pacing.fps_min) {
    out.too_slow = true;
    out.words =
        fmt::format("too slow live: {:.3g} frames/s, below fps_min = {:.4g}", alone, protocol.pacing.fps_min);
  }
}

/// Judges a rehearsed trial by the protocol's timing bounds and writes the result into `out`.
void judge_showing(MeasuredCell& out, const Protocol& protocol, const PlayedTrial& played,
                   double refresh_hz) {
  if (out.too_slow) return;
  const auto verdict = judge_trial(out.setting, for_display(protocol.pacing, refresh_hz), played,
                                   protocol.timing, TimingGrade::CpuSubmit);
  out.too_slow = verdict.verdict == Verdict::Fail;
  if (verdict.verdict != Verdict::Pass)
    out.words = "a trial would " + std::string(out.too_slow ? "fail: " : "be degraded: ") + verdict.reason;
}

MeasuredCell judge(const Protocol& protocol, const MeasuredStimulus& measured, int index, double refresh_hz,
                   const IntervalsOf& intervals_of) {
  const Cell& cell = protocol.design.cells.at(static_cast<std::size_t>(index));
  const auto intervals_ns = cell.setting.mean > 0 ? intervals_of(cell.setting) : std::vector<std::int64_t>();
  const Rehearsal rehearsal = rehearse(protocol, cell.setting, measured.times, intervals_ns, refresh_hz);
  MeasuredCell out;
  out.cell = index;
  out.what = cell.stimulus;
  out.setting = cell.setting;
  out.showing_s = rehearsal.showing_s;
  if (rehearsal.frame_s.empty()) return out;  // a trial of one frame: the first frame's time does not count
  std::vector<double> shown_s, sorted = rehearsal.frame_s;
  for (const double s : rehearsal.frame_s)
    shown_s.push_back(refresh_hz > 0 ? std::max(s, 1 / refresh_hz) : s);
  out.fps = stats::fps_moments(shown_s);
  out.tau_min = least_tau(shown_s);
  // Excludes frames with steps that were not measured, because rehearse() only estimates their times.
  if (rehearsal.measured > 0) sorted.resize(rehearsal.measured);
  std::sort(sorted.begin(), sorted.end());
  for (const double s : sorted) out.mean_ms += 1000 * s / static_cast<double>(sorted.size());
  out.p95_ms = 1000 * sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  judge_rate(out, protocol, stats::fps_moments(rehearsal.frame_s).mean);
  if (!intervals_ns.empty()) judge_showing(out, protocol, rehearsal.played, refresh_hz);
  return out;
}

/// The reason why participants would compare equal stimuli (MeasuredReport::collapse); empty if they would
/// not. temporal: by cell, true if the cell's method has temporal acceleration.
std::string collapse_of(const std::vector<MeasuredCell>& cells, const std::map<int, bool>& temporal,
                        double refresh_hz) {
  std::set<std::string> methods, levels;
  bool all_reach = true, any_temporal = false, accelerates = false;
  for (const MeasuredCell& one : cells) {
    methods.insert(one.what.method);
    levels.insert(one.what.effects);
    all_reach = all_reach && one.fps.mean >= at_refresh * refresh_hz;
    any_temporal = any_temporal || temporal.at(one.cell);
    accelerates = accelerates || (temporal.at(one.cell) && one.tau_min < 0);
  }
  // Cells with one method but several levels of effects differ in their effects, whatever their frame rates.
  if (all_reach && !(methods.size() == 1 && levels.size() > 1))
    return fmt::format("every method reaches the {:g} Hz of the display", refresh_hz);
  if (any_temporal && !accelerates) return "tau of the accelerated methods never falls below zero";
  return {};
}

}  // namespace

std::vector<StimulusSpec> stimuli_of(const Protocol& protocol) {
  std::vector<StimulusSpec> out;
  for (const auto& cell : protocol.design.cells) {
    if (std::find(out.begin(), out.end(), cell.stimulus) == out.end()) out.push_back(cell.stimulus);
  }
  return out;
}

MeasuredReport judge_measured(const Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz, const IntervalsOf& intervals_of) {
  MeasuredReport out;
  std::map<int, bool> temporal;
  for (const auto& one : measured) {
    for (const int cell : one.cells) {
      temporal[cell] = one.temporal;
      out.cells.push_back(judge(protocol, one, cell, refresh_hz, intervals_of));
    }
  }
  std::sort(out.cells.begin(), out.cells.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
  out.too_slow =
      std::any_of(out.cells.begin(), out.cells.end(), [](const auto& one) { return one.too_slow; });
  if (protocol.design.timing == TimingSource::Native && refresh_hz > 0 && !out.cells.empty())
    out.collapse = collapse_of(out.cells, temporal, refresh_hz);
  return out;
}

std::string stimulus_name(const StimulusSpec& what) {
  return what.method + " " + std::filesystem::path(what.scene).stem().string() + " " + what.n_star +
         (what.effects.empty() ? "" : " " + what.effects) + (what.surface.empty() ? "" : " " + what.surface);
}

std::string measured_table(const MeasuredReport& report) {
  const auto asked = [](const MeasuredCell& one) {
    return one.setting.mean > 0 ? setting_name(one.setting) : "as it runs";
  };
  std::size_t width = 28, asked_width = 15;
  for (const MeasuredCell& one : report.cells) {
    width = std::max(width, stimulus_name(one.what).size());
    asked_width = std::max(asked_width, asked(one).size());
  }
  std::string out = fmt::format("{:<{}} {:<{}} {:>9} {:>8} {:>8} {:>8}\n", "stimulus", width, "asked",
                                asked_width, "frames/s", "sd", "p95 ms", "tau min");
  for (const MeasuredCell& one : report.cells) {
    out += fmt::format("{:<{}} {:<{}} {:9.1f} {:8.2f} {:8.1f} {:8.2f}  ", stimulus_name(one.what), width,
                       asked(one), asked_width, one.fps.mean, one.fps.sd, one.p95_ms, one.tau_min) +
           one.words + "\n";
  }
  return out;
}

std::vector<FrameCosts> frame_costs(const MeasuredReport& report) {
  std::vector<FrameCosts> out;
  for (const MeasuredCell& one : report.cells)
    if (one.mean_ms > 0) out.push_back({one.what, one.mean_ms, one.p95_ms});
  return out;
}

std::vector<double> showing_times(const Protocol& protocol, const MeasuredReport& report) {
  std::vector<double> out;
  for (const Cell& cell : protocol.design.cells) out.push_back(cell.setting.duration_s);
  for (const MeasuredCell& one : report.cells) out[static_cast<std::size_t>(one.cell)] = one.showing_s;
  return out;
}

}  // namespace study
