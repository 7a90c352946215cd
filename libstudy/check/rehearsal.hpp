#pragma once
/// Simulates a trial on this machine: plays it on a virtual clock with the measured frame times.

#include <cstdint>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// By content step after start_frame: seconds to compute and to draw it without waiting. The first step is
/// made before a trial begins.
struct StepTimes {
  std::vector<double> compute_s, draw_s;
};

/// Measured times of one stimulus on this machine.
struct MeasuredStimulus {
  std::vector<int> cells;  ///< cells that show it, indices into Design::cells, ascending
  bool temporal = false;   ///< its method has temporal acceleration
  StepTimes times;
};

/// Number of content steps of a showing. refresh_hz: the bound without a schedule; 0: 60.
std::int64_t content_steps(const Protocol& protocol, const FpsSetting& setting, double refresh_hz);

struct Rehearsal {
  PlayedTrial played;
  std::vector<double> frame_s;  ///< time of each frame but the first
  std::size_t measured = 0;     ///< number of leading entries whose steps were all measured
  double showing_s = 0;         ///< from the first onset to the end
};

/// Plays a cell by study::play_trial(), or without a schedule by study::play_native() with no frame shorter
/// than the refresh period (0: no bound). intervals_ns: of the schedule; empty: all equal. Steps that were
/// not measured take the mean time of the last measured ones.
Rehearsal rehearse(const Protocol& protocol, const FpsSetting& setting, const StepTimes& times,
                   const std::vector<std::int64_t>& intervals_ns, double refresh_hz);

}  // namespace study
