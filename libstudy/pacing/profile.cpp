#include "libstudy/pacing/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "libstudy/base/random.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

constexpr std::array profile_words{"moments", "hitches", "floor", "trace"};
constexpr double low_share = 0.05;  // share of the frames, the longest: their rate is the "5 % low", low_fps

[[noreturn]] void refuse(const std::string& problem) {
  throw base::Error("timing", problem, "change the numbers of this timing, or the length of the stimulus");
}

std::vector<double> hitches(const TimingProfile& profile, double duration_s, std::uint64_t seed) {
  const double base_s = 1 / profile.mean_fps, hitch_s = 1e-3 * profile.hitch_ms;
  if (hitch_s < base_s)
    refuse(fmt::format("a hitch of {:g} ms is shorter than the {:.4g} ms of a frame at {:g} frames/s",
                       profile.hitch_ms, 1e3 * base_s, profile.mean_fps));
  if (hitch_s + base_s > profile.period_s)
    refuse(fmt::format("a hitch of {:g} ms and a frame do not fit into a period of {:g} s", profile.hitch_ms,
                       profile.period_s));
  RandomStream random(seed);
  std::vector<double> out;
  double time_s = 0;
  int period = 0;
  const auto next_hitch = [&] {
    return (period + 0.5 + profile.jitter * (random.uniform() - 0.5)) * profile.period_s;
  };
  double hitch_at_s = next_hitch();
  while (time_s < duration_s - base_s / 2) {
    // The frame that is on at hitch_at_s becomes the hitch, if the stimulus lasts long enough for the hitch.
    const bool now = hitch_at_s < time_s + base_s && time_s + hitch_s < duration_s + base_s / 2;
    out.push_back(now ? hitch_s : base_s);
    time_s += out.back();
    if (now) {
      ++period;
      hitch_at_s = next_hitch();
    }
  }
  return out;
}

std::vector<double> with_floor(const TimingProfile& profile, double duration_s, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(profile.mean_fps * duration_s)));
  const auto low = static_cast<std::size_t>(std::ceil(low_share * static_cast<double>(count)));
  const double low_s = static_cast<double>(low) / profile.low_fps;
  const double left_s = static_cast<double>(count) / profile.mean_fps - low_s;
  if (profile.low_fps > profile.mean_fps || count <= low || left_s <= 0)
    refuse(fmt::format(
        "{} frames with a mean of {:g} frames/s cannot have a 5 % low of {:g} frames/s: it must be "
        "above {:.4g} and at most {:g}",
        count, profile.mean_fps, profile.low_fps,
        profile.mean_fps * static_cast<double>(low) / static_cast<double>(count), profile.mean_fps));
  std::vector<double> out(count, left_s / static_cast<double>(count - low));
  std::fill_n(out.begin(), low, 1 / profile.low_fps);
  RandomStream random(seed);
  shuffle(out, random);
  return out;
}

std::vector<double> of_trace(const TimingProfile& profile, double duration_s) {
  std::vector<double> out;
  double time_s = 0;
  for (std::size_t i = 0; time_s < duration_s && !profile.frame_ms.empty(); ++i) {
    const double next_s = 1e-3 * profile.frame_ms[i % profile.frame_ms.size()];
    if (!out.empty() && time_s + next_s / 2 > duration_s) break;
    out.push_back(next_s);
    time_s += next_s;
  }
  if (out.empty()) refuse("the trace holds no frame");
  if (profile.smoothed) std::ranges::fill(out, time_s / static_cast<double>(out.size()));
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

std::vector<double> pattern_intervals(const TimingProfile& profile, double duration_s, std::uint64_t seed) {
  switch (profile.kind) {
    case ProfileKind::Hitches:
      return hitches(profile, duration_s, seed);
    case ProfileKind::Floor:
      return with_floor(profile, duration_s, seed);
    case ProfileKind::Trace:
      return of_trace(profile, duration_s);
    case ProfileKind::Moments:
      break;
  }
  throw std::invalid_argument(
      "pattern_intervals(): a profile of kind Moments has no pattern; use compile_schedule() for it");
}

}  // namespace study
