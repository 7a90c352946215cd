#pragma once
/// Measures a screen's refresh from the times at which buffer swaps returned. A beat is an instant at which
/// the screen takes over a new picture.

#include <cstdint>
#include <span>
#include <string>

namespace study {

struct MeasuredRefresh {
  bool in_effect = false;    ///< true: swaps wait for the screen
  double nominal_hz = 0;     ///< rate for schedules; 0: swaps do not wait for the screen
  double period_ns = 0;      ///< measured refresh period; 0: swaps do not wait for the screen
  std::int64_t beat_ns = 0;  ///< time of one beat: the screen takes over a picture
  std::string finding;       ///< the result in words, for the record
};

/// Derives the refresh from the return times of successive swaps, each followed by glFinish(). reported_hz:
/// rate reported by the system; 0: none. nominal_hz comes from study::nominal_refresh(), such as 60 for a
/// measured rate of 59.95 Hz. in_effect is false for fewer than 20 swaps, for a median step outside 2 to 50
/// ms, and if more than a tenth of the steps differ by a tenth of the median step or more from each multiple
/// of it.
MeasuredRefresh judge_swaps(std::span<const std::int64_t> returns_ns, double reported_hz);

/// The time at which the screen took over the picture of the last swap (its beat). A swap returns at its beat
/// or shortly after. So the result is the earliest of all return times, after each was shifted by whole
/// periods to the last swap.
std::int64_t beat_of(std::span<const std::int64_t> returns_ns, double period_ns);

/// The first instant from earliest_ns on in the middle between two beats (times at which the screen takes
/// over a picture). A frame submitted at that instant is least likely to slip into another period. Returns
/// earliest_ns if swaps do not wait for the screen.
std::int64_t between_beats(const MeasuredRefresh& refresh, std::int64_t earliest_ns);

/// The time at which the screen takes over a frame submitted at handed_over_ns: the next beat. -1 if swaps do
/// not wait for the screen.
std::int64_t next_beat(const MeasuredRefresh& refresh, std::int64_t handed_over_ns);

}  // namespace study
