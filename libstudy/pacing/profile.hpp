#pragma once
/// Timing profiles: how long each frame of a stimulus stays on, beyond a mean and a standard deviation.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/pacing/schedule.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// In protocols: profile_word(), e.g. "hitches".
enum class ProfileKind {
  Moments,  ///< mean_fps and sd_fps, as in protocols of formats 1 and 2
  Hitches,  ///< a steady rate; one frame in each period stays on for hitch_ms
  Floor,    ///< one frame in 20 lasts 1/low_fps; the others share the rest of the time evenly
  Trace     ///< recorded frame times, in their order, repeated or cut to the length of the stimulus
};

struct TimingProfile {
  ProfileKind kind = ProfileKind::Moments;
  double mean_fps = 60;  ///< Moments, Floor: harmonic mean. Hitches: rate between hitches. Frames/s
  double sd_fps = 0;     ///< Moments
  double hitch_ms = 0;   ///< Hitches: time for which the long frame stays on; at least 1000 / mean_fps
  double period_s = 1;   ///< Hitches: one hitch in each period, in its middle when jitter is 0
  double jitter = 0;     ///< Hitches: the hitch is uniform over this middle part of the period, 0 to 1
  double low_fps = 0;    ///< Floor: "5 % low", at most mean_fps
  std::vector<double> frame_ms = {};  ///< Trace
  bool smoothed = false;              ///< Trace: as many frames in the same time, all equally long
  /// The content shown lags behind by this constant, ms. Real-time content only.
  double latency_ms = 0;
  /// The step of the content differs from the step of the display by this much, alternately more and less,
  /// ms. Real-time content only.
  double animation_error_ms = 0;

  bool operator==(const TimingProfile&) const = default;
};

/// "moments", "hitches", "floor", "trace".
const char* profile_word(ProfileKind kind);
/// The profile in words and numbers, such as "60 frames/s, a hitch of 100 ms every 2 s". Equal profiles give
/// equal words; a trace is named by its number of frames and the first digits of a hash.
std::string profile_text(const TimingProfile& profile);

/// A profile as a display shows it.
struct CompiledProfile {
  Feasibility feasibility = Feasibility::Unreachable;
  std::vector<std::int64_t> intervals_ns;  ///< empty when unreachable
  stats::FpsMoments moments;               ///< of these intervals
  std::string reason;                      ///< why it is not exact
};

/// The intervals of one showing. refresh_hz = 0: the display has no fixed refresh and shows any interval.
/// With a fixed refresh each deadline moves to the nearest period, at least one period after the last one.
/// Exact: no interval moved by more than 1 % of itself. Approximate: the mean moved by at most 0.5 %. Equal
/// seeds give equal intervals. Moments: compile_schedule() and quantise() with these rules; the other kinds
/// use no rules. An impossible profile is unreachable with its reason, such as a floor above the mean.
CompiledProfile compile_profile(const TimingProfile& profile, double duration_s, const PacingRules& rules,
                                double refresh_hz, std::uint64_t seed);

}  // namespace study
