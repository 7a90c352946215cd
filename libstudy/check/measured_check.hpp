#pragma once
/// Checks that this machine reaches a protocol's settings if methods run live.

#include <functional>
#include <string>
#include <vector>

#include "libstudy/check/rehearsal.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// The different stimuli of a protocol in the order of its cells.
std::vector<StimulusSpec> stimuli_of(const Protocol& protocol);

/// The result for one cell.
struct MeasuredCell {
  int cell = 0;  ///< index into Design::cells
  StimulusSpec what;
  FpsSetting setting;
  stats::FpsMoments fps;  ///< of its frames, with the display's refresh as the highest rate
  double mean_ms = 0;     ///< mean time to compute and draw a frame without waiting
  double p95_ms = 0;      ///< the same, 95th percentile
  double tau_min = 0;     ///< least tau over 30 frames, frames/s (Eq. 11)
  double showing_s = 0;   ///< expected duration of a showing
  bool too_slow = false;  ///< its setting is not reached: a showing would fail
  std::string words;      ///< the problem; empty: none
};

struct MeasuredReport {
  std::vector<MeasuredCell> cells;  ///< in the order of the design
  bool too_slow = false;            ///< at least one of them
  std::string collapse;             ///< why `native` would compare equal stimuli; empty if not
};

/// The schedule of a setting on the display, nanoseconds; empty if it has none.
using IntervalsOf = std::function<std::vector<std::int64_t>(const FpsSetting&)>;

/// refresh_hz: of the display; 0: frames are shown when ready. Under a schedule, a cell is too slow if its
/// mean time exceeds the mean interval or its rehearsal fails by the protocol's bounds (not checked without
/// intervals); under TimingSource::Native, if its rate stays below fps_min. Under Native, the conditions
/// collapse if the methods of every group all reach the refresh, or if no method with temporal acceleration
/// ever has tau below zero.
MeasuredReport judge_measured(const Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz, const IntervalsOf& intervals_of);

/// "HiRes single_dam 32k".
std::string stimulus_name(const StimulusSpec& what);
/// The report as text, one line per cell below a heading.
std::string measured_table(const MeasuredReport& report);
/// Frame costs of each measured cell, for the record.
std::vector<FrameCosts> frame_costs(const MeasuredReport& report);
/// Duration of a showing of each cell of the design here, s; the planned one if a cell was not measured.
std::vector<double> showing_times(const Protocol& protocol, const MeasuredReport& report);

}  // namespace study
