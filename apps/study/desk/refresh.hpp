#pragma once
/// What a screen's beat is, from the instants at which buffer swaps came back.

#include <cstdint>
#include <span>
#include <string>

namespace apps {

struct MeasuredRefresh {
  bool in_effect = false;    ///< swaps wait for the screen
  double nominal_hz = 0;     ///< what schedules count by; 0: frames are shown as they come
  double period_ns = 0;      ///< measured; 0 likewise
  std::int64_t beat_ns = 0;  ///< one of the instants at which the screen took a picture
  std::string finding;       ///< in words, for the record
};

/// From successive returns of a swap that waits until it is done. told_hz: what the system says of the
/// screen; 0: nothing. The nominal rate is study::nominal_refresh: 60 for 59.95.
/// Swaps that do not keep time (steps that are no multiples of a period of 2 to 50 ms) are not in effect.
MeasuredRefresh judge_swaps(std::span<const std::int64_t> returns_ns, double told_hz);

/// The beat that the last of some swaps met: each came back at a beat or a little after it, never before.
std::int64_t beat_of(std::span<const std::int64_t> returns_ns, double period_ns);

/// The first instant from earliest_ns on that lies in the middle between two beats: schedules that begin
/// there keep the largest distance from the edge where a frame would slip into another period. earliest_ns
/// itself without a beat.
std::int64_t between_beats(const MeasuredRefresh& refresh, std::int64_t earliest_ns);

/// The first beat after an instant: when what is handed over then appears. -1 without a beat.
std::int64_t next_beat(const MeasuredRefresh& refresh, std::int64_t handed_over_ns);

}  // namespace apps
