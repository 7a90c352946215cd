#include "libstudy/pacing/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "libstudy/base/random.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

constexpr std::array profile_words{"moments", "hitches", "floor", "trace"};
constexpr double exact_share = 0.01;         // largest change of an interval, as a share of itself
constexpr double approximate_share = 0.005;  // largest change of the mean
constexpr double low_share = 0.05;           // of frames in a "5 % low"

/// Intervals in seconds before a display rounds them; `reason` says why there are none.
struct Wanted {
  std::vector<double> intervals_s;
  std::string reason;
};

Wanted hitches(const TimingProfile& profile, double duration_s, std::uint64_t seed) {
  const double base_s = 1 / profile.mean_fps, hitch_s = 1e-3 * profile.hitch_ms;
  if (hitch_s < base_s)
    return {{},
            fmt::format("a hitch of {:g} ms is shorter than a frame at {:g} frames/s", profile.hitch_ms,
                        profile.mean_fps)};
  if (hitch_s + base_s > profile.period_s)
    return {{},
            fmt::format("a hitch of {:g} ms and a frame do not fit into {:g} s", profile.hitch_ms,
                        profile.period_s)};
  RandomStream random(seed);
  Wanted out;
  double time_s = 0;
  int period = 0;
  const auto next_hitch = [&] {
    return (period + 0.5 + profile.jitter * (random.uniform() - 0.5)) * profile.period_s;
  };
  double hitch_at_s = next_hitch();
  while (time_s < duration_s - base_s / 2) {
    // A hitch begins with the frame that is on at its time, if the stimulus lasts long enough for it.
    const bool now = hitch_at_s < time_s + base_s && time_s + hitch_s < duration_s + base_s / 2;
    out.intervals_s.push_back(now ? hitch_s : base_s);
    time_s += out.intervals_s.back();
    if (now) {
      ++period;
      hitch_at_s = next_hitch();
    }
  }
  return out;
}

Wanted floor_of(const TimingProfile& profile, double duration_s, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(frame_count({profile.mean_fps, 0, duration_s}));
  const auto low = static_cast<std::size_t>(std::ceil(low_share * static_cast<double>(count)));
  const double left_s =
      static_cast<double>(count) / profile.mean_fps - static_cast<double>(low) / profile.low_fps;
  const double rest_s = count > low ? left_s / static_cast<double>(count - low) : 0;
  if (rest_s <= 0 || profile.low_fps > profile.mean_fps)
    return {{},
            fmt::format("a mean of {:g} frames/s cannot have a 5 % low of {:g} frames/s", profile.mean_fps,
                        profile.low_fps)};
  Wanted out;
  out.intervals_s.assign(count, rest_s);
  std::fill_n(out.intervals_s.begin(), low, 1 / profile.low_fps);
  RandomStream random(seed);
  shuffle(out.intervals_s, random);
  return out;
}

Wanted trace_of(const TimingProfile& profile, double duration_s) {
  Wanted out;
  double time_s = 0;
  for (std::size_t i = 0; time_s < duration_s && !profile.frame_ms.empty(); ++i) {
    const double next_s = 1e-3 * profile.frame_ms[i % profile.frame_ms.size()];
    if (!out.intervals_s.empty() && time_s + next_s / 2 > duration_s) break;
    out.intervals_s.push_back(next_s);
    time_s += next_s;
  }
  if (out.intervals_s.empty()) return {{}, "the trace holds no frame"};
  if (profile.smoothed)
    std::ranges::fill(out.intervals_s, time_s / static_cast<double>(out.intervals_s.size()));
  return out;
}

/// Deadlines at the nearest whole tick, at least one tick apart.
std::vector<std::int64_t> ticks_of(const std::vector<double>& intervals_s, double tick_s) {
  std::vector<std::int64_t> out;
  double time_s = 0;
  std::int64_t last = 0;
  for (const double interval : intervals_s) {
    time_s += interval;
    const std::int64_t tick = std::max<std::int64_t>(last + 1, std::llround(time_s / tick_s));
    out.push_back(tick - last);
    last = tick;
  }
  return out;
}

void measure_profile(CompiledProfile& out) {
  std::vector<double> seconds;
  for (const std::int64_t ns : out.intervals_ns) seconds.push_back(1e-9 * static_cast<double>(ns));
  out.moments = stats::fps_moments(seconds);
}

CompiledProfile compile_moments(const TimingProfile& profile, double duration_s, const PacingRules& rules,
                                double refresh_hz, std::uint64_t seed) {
  const FpsSetting setting{profile.mean_fps, profile.sd_fps, duration_s};
  CompiledProfile out;
  if (refresh_hz > 0) {
    const RefreshVerdict verdict = quantise(setting, rules, refresh_hz, seed);
    out.feasibility = verdict.feasibility;
    out.reason = verdict.reason;
    if (verdict.feasibility != Feasibility::Unreachable)
      out.intervals_ns = schedule_of_holds(verdict.holds, refresh_hz).intervals_ns;
  } else {
    try {
      out.intervals_ns = compile_schedule(setting, for_display(rules, 0), seed).intervals_ns;
      out.feasibility = Feasibility::Exact;
    } catch (const base::Error& error) {
      const std::string message = error.what();
      out.reason = message.substr(0, message.find('\n'));
    }
  }
  measure_profile(out);
  return out;
}

/// Rounds to a display's periods and says what that changes.
CompiledProfile round_to_display(const std::vector<double>& intervals_s, double refresh_hz) {
  CompiledProfile out;
  const double tick_s = refresh_hz > 0 ? 1 / refresh_hz : 1e-9;
  const auto ticks = ticks_of(intervals_s, tick_s);
  double worst = 0, wanted_s = 0;
  std::int64_t all = 0, last_ns = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    all += ticks[i];
    wanted_s += intervals_s[i];
    worst = std::max(worst, std::abs(static_cast<double>(ticks[i]) * tick_s / intervals_s[i] - 1));
    const std::int64_t end_ns = std::llround(1e9 * static_cast<double>(all) * tick_s);
    out.intervals_ns.push_back(end_ns - last_ns);
    last_ns = end_ns;
  }
  measure_profile(out);
  const double mean_error = std::abs(static_cast<double>(all) * tick_s / wanted_s - 1);
  out.feasibility = worst <= exact_share              ? Feasibility::Exact
                    : mean_error <= approximate_share ? Feasibility::Approximate
                                                      : Feasibility::Unreachable;
  if (out.feasibility == Feasibility::Approximate)
    out.reason =
        fmt::format("frames move by up to {:.0f} % to fit periods of {:.4g} ms", 100 * worst, 1e3 * tick_s);
  if (out.feasibility == Feasibility::Unreachable) {
    out.reason = fmt::format("with periods of {:.4g} ms the mean is {:.4g} instead of {:.4g} frames/s",
                             1e3 * tick_s, out.moments.mean, static_cast<double>(ticks.size()) / wanted_s);
    out.intervals_ns.clear();
  }
  return out;
}

std::string trace_text(const TimingProfile& profile) {
  std::string all;
  for (const double ms : profile.frame_ms) all += fmt::format("{:.17g},", ms);
  return fmt::format("a trace of {} frames ({}){}", profile.frame_ms.size(),
                     base::sha256_hex(all).substr(0, 8), profile.smoothed ? ", smoothed" : "");
}

std::string frames_text(const TimingProfile& profile) {
  switch (profile.kind) {
    case ProfileKind::Moments:
      return fmt::format("mean {:g}, SD {:g} frames/s", profile.mean_fps, profile.sd_fps);
    case ProfileKind::Hitches:
      return fmt::format("{:g} frames/s, a hitch of {:g} ms every {:g} s", profile.mean_fps, profile.hitch_ms,
                         profile.period_s) +
             (profile.jitter > 0 ? fmt::format(", jitter {:g}", profile.jitter) : "");
    case ProfileKind::Floor:
      return fmt::format("mean {:g} frames/s, 5 % low {:g} frames/s", profile.mean_fps, profile.low_fps);
    case ProfileKind::Trace:
      break;
  }
  return trace_text(profile);
}

}  // namespace

const char* profile_word(ProfileKind kind) { return profile_words[static_cast<std::size_t>(kind)]; }

std::string profile_text(const TimingProfile& profile) {
  std::string out = frames_text(profile);
  if (profile.latency_ms > 0) out += fmt::format(", latency {:g} ms", profile.latency_ms);
  if (profile.animation_error_ms > 0)
    out += fmt::format(", animation error {:g} ms", profile.animation_error_ms);
  return out;
}

CompiledProfile compile_profile(const TimingProfile& profile, double duration_s, const PacingRules& rules,
                                double refresh_hz, std::uint64_t seed) {
  if (profile.kind == ProfileKind::Moments)
    return compile_moments(profile, duration_s, rules, refresh_hz, seed);
  const Wanted wanted = profile.kind == ProfileKind::Hitches ? hitches(profile, duration_s, seed)
                        : profile.kind == ProfileKind::Floor ? floor_of(profile, duration_s, seed)
                                                             : trace_of(profile, duration_s);
  if (wanted.intervals_s.empty()) {
    CompiledProfile out;
    out.reason = wanted.reason;
    return out;
  }
  return round_to_display(wanted.intervals_s, refresh_hz);
}

}  // namespace study
