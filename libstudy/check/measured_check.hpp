#pragma once
/// Predicts from measured step times whether this machine computes and draws the fluid at the frame rates of
/// a protocol while it shows it.

#include <functional>
#include <string>
#include <vector>

#include "libstudy/check/rehearsal.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// The distinct stimuli of a protocol, in the order of their first cells.
std::vector<StimulusSpec> stimuli_of(const Protocol& protocol);

/// The result of judge_measured() for one cell of the design.
struct MeasuredCell {
  int cell = 0;  ///< index into Design::cells
  StimulusSpec what;
  FpsSetting setting;
  stats::FpsMoments fps;  ///< frame rate; each frame counts as at least one refresh period long
  double mean_ms = 0;     ///< mean time to compute and draw a frame, without waiting
  double p95_ms = 0;      ///< 95th percentile of the time to compute and draw a frame, without waiting
  /// Smallest ptpe_tolerance() over windows of up to 30 frames, frames/s; < 0: acceleration is needed.
  double tau_min = 0;
  double showing_s = 0;   ///< expected duration of a showing of the cell, s
  bool too_slow = false;  ///< the machine misses the frame rate or timing; see judge_measured()
  std::string words;      ///< why the cell is too slow or its showings would be degraded; empty if neither
};

struct MeasuredReport {
  std::vector<MeasuredCell> cells;  ///< in the order of the design
  bool too_slow = false;            ///< at least one cell is too slow
  std::string collapse;             ///< why participants would compare equal stimuli under timing `native`;
                                    ///< empty if they would not
};

/// Returns the frame intervals of a setting on the display, ns; empty if the setting has no schedule on the
/// display.
using IntervalsOf = std::function<std::vector<std::int64_t>(const FpsSetting&)>;

/// Rehearses each measured cell (plays it on a virtual clock with the measured times) and judges it.
/// refresh_hz: rate of the display; 0: frames are shown when ready.
///
/// A cell with a requested frame rate is too slow if the machine's mean frame rate without waiting is below
/// the requested rate. The cell is also too slow if its rehearsal fails the protocol's timing bounds; a cell
/// without intervals skips this check. A cell without a requested rate (TimingSource::Native) is too slow if
/// the machine's mean frame rate is below the protocol's fps_min. A cell with a showing of one frame is not
/// judged.
///
/// MeasuredReport::collapse is set only under Native (each frame is shown when ready) on a display with a
/// fixed refresh, for one of two reasons. First: all cells reach 98 % of the refresh rate, and do not have
/// one method with several levels of effects. Second: the design has accelerated methods, but tau never falls
/// below zero in their cells, so that these methods never accelerate.
MeasuredReport judge_measured(const Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz, const IntervalsOf& intervals_of);

/// Method, scene and n_* of a stimulus as text: "HiRes single_dam 32k"; its effects follow, if any.
std::string stimulus_name(const StimulusSpec& what);
/// The report as a table in text: a heading, then one line per cell.
std::string measured_table(const MeasuredReport& report);
/// Mean and 95th percentile of the time per frame, for the cells that have them, to be stored with a session.
std::vector<FrameCosts> frame_costs(const MeasuredReport& report);
/// Expected duration of a showing on this machine, s, for each cell of the design; the planned duration if
/// the cell was not measured.
std::vector<double> showing_times(const Protocol& protocol, const MeasuredReport& report);

}  // namespace study
