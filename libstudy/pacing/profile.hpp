#pragma once
/// Timing profiles: descriptions of how long each frame of a stimulus stays on, such as a mean and a standard
/// deviation, hitches, or recorded frame times.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace study {

/// The kind of a timing profile. Protocols name it by its profile_word(), e.g. "hitches".
enum class ProfileKind {
  Moments,  ///< a frame rate with the mean mean_fps and the standard deviation sd_fps
  Hitches,  ///< a steady rate; one frame in each period stays on for hitch_ms
  Floor,    ///< 5 % of the frames (rounded up) last 1/low_fps; the others are equally long
  Trace     ///< recorded frame times, in their order, repeated or cut to the length of the stimulus
};

/// Bounds of the frame times of a trace, ms, and of their number.
inline constexpr double shortest_trace_ms = 0.1, longest_trace_ms = 10000;
inline constexpr std::size_t most_trace_frames = 100000;

struct TimingProfile {
  ProfileKind kind = ProfileKind::Moments;
  double mean_fps = 60;  ///< frames/s; Moments: mean; Floor: harmonic mean; Hitches: rate between hitches
  double sd_fps = 0;     ///< Moments: standard deviation, frames/s
  double hitch_ms = 0;   ///< Hitches: time for which the long frame stays on; at least 1000 / mean_fps
  double period_s = 1;   ///< Hitches: period, s; one hitch in each, in its middle when jitter is 0
  /// Hitches: share of the period, around its middle, over which the hitch is uniform, 0 to 1
  double jitter = 0;
  double low_fps = 0;  ///< Floor: rate of the longest 5 % of the frames, frames/s; at most mean_fps
  std::vector<double> frame_ms = {};  ///< Trace: recorded frame times, ms
  bool smoothed = false;              ///< Trace: true: as many frames in the same time, but all equally long
  /// The content shown lags behind the time of its frame by this constant, ms. Real-time content only.
  double latency_ms = 0;
  /// The content's step between two frames differs from the interval between them by this much, alternately
  /// more and less, ms. Real-time content only.
  double animation_error_ms = 0;

  bool operator==(const TimingProfile&) const = default;
};

/// "moments", "hitches", "floor", "trace".
const char* profile_word(ProfileKind kind);
/// The profile in words and numbers, such as "60 frames/s, a hitch of 100 ms every 2 s". Equal profiles give
/// equal words; a trace is named by its number of frames and the first digits of a hash.
std::string profile_text(const TimingProfile& profile);

/// The times for which frames stay on, seconds, before a display rounds them. Not for ProfileKind::Moments,
/// which compile_schedule() handles. Equal seeds give equal intervals. base::Error if the numbers contradict
/// each other, such as a floor above the mean.
std::vector<double> pattern_intervals(const TimingProfile& profile, double duration_s, std::uint64_t seed);

}  // namespace study
