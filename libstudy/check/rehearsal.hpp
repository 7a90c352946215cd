#pragma once
/// Simulates a trial on this machine: plays it on a virtual clock with the measured frame times.

#include <cstdint>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Times to compute and to draw each content step without waiting, s. The index counts steps from start_frame
/// on. Index 0 has times of 0 s, because that step is computed before a trial begins.
struct StepTimes {
  std::vector<double> compute_s, draw_s;
};

/// Measured times of one stimulus on this machine.
struct MeasuredStimulus {
  std::vector<int> cells;  ///< cells with this stimulus: indices into Design::cells, ascending
  bool temporal = false;   ///< true if the method has temporal acceleration
  StepTimes times;
};

/// Largest number of content steps in a showing. If the setting has no frame rate and the content does not
/// play in real time, this is the number of refreshes: at refresh_hz, or at 60 Hz if refresh_hz is 0.
std::int64_t content_steps(const Protocol& protocol, const FpsSetting& setting, double refresh_hz);

struct Rehearsal {
  PlayedTrial played;
  std::vector<double> frame_s;  ///< time to compute and draw each frame but the first, s
  std::size_t measured = 0;     ///< number of leading entries of frame_s whose steps were all measured
  double showing_s = 0;         ///< duration from the first frame's onset to the end of the showing
};

/// Plays a trial of one setting on a virtual clock. play_trial() plays a setting with a mean rate, with
/// `intervals_ns` or, if this list is empty, with equal intervals. play_native() plays a setting without a
/// mean rate; each frame then lasts at least a refresh period (no bound if refresh_hz is 0). A step that was
/// not measured takes the mean time of the last 30 measured steps.
Rehearsal rehearse(const Protocol& protocol, const FpsSetting& setting, const StepTimes& times,
                   const std::vector<std::int64_t>& intervals_ns, double refresh_hz);

}  // namespace study
