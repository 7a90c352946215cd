#pragma once
/// A trial as this machine would show it, played on a virtual clock with frames that take what was measured.

#include <cstdint>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// By content step after start_frame: seconds to compute it and to draw it with nothing to wait for. The
/// first step is made before a trial begins.
struct StepTimes {
  std::vector<double> compute_s, draw_s;
};

/// One stimulus as this machine made it.
struct MeasuredStimulus {
  std::vector<int> cells;  ///< that show it, indices into Design::cells, ascending
  bool temporal = false;   ///< of a method with temporal acceleration
  StepTimes times;
};

/// Content steps that a showing goes through. refresh_hz: bounds it without a schedule; 0: 60.
std::int64_t content_steps(const study::Protocol& protocol, const study::FpsSetting& setting,
                           double refresh_hz);

struct Rehearsal {
  study::PlayedTrial played;
  std::vector<double> frame_s;  ///< that each frame took, but the first
  std::size_t measured = 0;     ///< so many of them, from the first, were of measured steps alone
  double showing_s = 0;         ///< from the first onset to the end
};

/// Plays a cell by study::play_trial(), or without a schedule by study::play_native(), where no frame is
/// shorter than the refresh (0: none). intervals_ns: of the schedule; empty: all are equal. Steps that were
/// not measured take what the last ones did.
Rehearsal rehearse(const study::Protocol& protocol, const study::FpsSetting& setting, const StepTimes& times,
                   const std::vector<std::int64_t>& intervals_ns, double refresh_hz);

}  // namespace apps
