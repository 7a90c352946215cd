#pragma once
/// Measures a screen's refresh from the times at which buffer swaps returned. A beat is an instant at which
/// the screen takes a picture.

#include <cstdint>
#include <span>
#include <string>

namespace study {

struct MeasuredRefresh {
  bool in_effect = false;    ///< swaps wait for the screen
  double nominal_hz = 0;     ///< rate for schedules; 0: frames are shown as they come
  double period_ns = 0;      ///< measured; 0: frames are shown as they come
  std::int64_t beat_ns = 0;  ///< time of one beat
  std::string finding;       ///< in words, for the record
};

/// Judges successive returns of a swap that waits until it is done. reported_hz: rate reported by the system;
/// 0: none. The nominal rate is study::nominal_refresh: 60 for 59.95. Irregular swaps (steps that are not
/// multiples of a period of 2 to 50 ms) are not in effect.
MeasuredRefresh judge_swaps(std::span<const std::int64_t> returns_ns, double reported_hz);

/// The beat of the last of some swaps: each returned at a beat or a little after it, never before.
std::int64_t beat_of(std::span<const std::int64_t> returns_ns, double period_ns);

/// The first instant from earliest_ns on in the middle between two beats, so that a schedule begins as far as
/// possible from the edges where a frame would move to another period. earliest_ns itself without a beat.
std::int64_t between_beats(const MeasuredRefresh& refresh, std::int64_t earliest_ns);

/// The first beat after an instant: when a frame submitted then appears. -1 without a beat.
std::int64_t next_beat(const MeasuredRefresh& refresh, std::int64_t handed_over_ns);

}  // namespace study
