#pragma once
/// Whether this machine shows what a protocol asks for when methods run live.

#include <functional>
#include <string>
#include <vector>

#include "apps/study/check/rehearsal.hpp"
#include "libstudy/store/frame_costs.hpp"
#include "stats/fps_window.hpp"

namespace apps {

/// The different stimuli of a protocol in the order of its cells.
std::vector<study::StimulusSpec> stimuli_of(const study::Protocol& protocol);

/// What follows for one cell.
struct MeasuredCell {
  int cell = 0;  ///< index into Design::cells
  study::StimulusSpec what;
  study::FpsSetting setting;
  stats::FpsMoments fps;  ///< of its frames, with the display's refresh as the highest rate
  double mean_ms = 0;     ///< of a frame, computed and drawn, with nothing to wait for
  double p95_ms = 0;      ///< the same, 95th percentile
  double tau_min = 0;     ///< least tau over 30 frames, frames/s (Eq. 11)
  double showing_s = 0;   ///< that a showing would take
  bool too_slow = false;  ///< its setting is not reached: a showing would fail
  std::string words;      ///< what is wrong; empty: nothing
};

struct MeasuredReport {
  std::vector<MeasuredCell> cells;  ///< in the order of the design
  bool too_slow = false;            ///< one of them at least
  std::string collapse;             ///< why `native` would compare equal stimuli; empty: it would not
};

/// The schedule of a setting on the display, nanoseconds; empty where it has none.
using IntervalsOf = std::function<std::vector<std::int64_t>(const study::FpsSetting&)>;

/// refresh_hz: of the display; 0: frames come as they are ready. Under a schedule a cell is too slow when its
/// mean time exceeds the mean interval, or when its rehearsal fails by the protocol's bounds (not asked where
/// there is no schedule); under
/// TimingSource::Native when its rate stays below fps_min. The conditions collapse under Native when the
/// methods of every group all reach the refresh, or when no method with temporal acceleration ever has tau
/// below zero.
MeasuredReport judge_measured(const study::Protocol& protocol, const std::vector<MeasuredStimulus>& measured,
                              double refresh_hz, const IntervalsOf& intervals_of);

/// "HiRes single_dam 32k".
std::string stimulus_name(const study::StimulusSpec& what);
/// The report for people, a line for each cell below a heading.
std::string measured_table(const MeasuredReport& report);
/// What frames cost here, for the record: of each cell that was measured.
std::vector<study::FrameCosts> frame_costs(const MeasuredReport& report);
/// Seconds that a showing of each cell of the design takes here: as planned where a cell was not measured.
std::vector<double> showing_times(const study::Protocol& protocol, const MeasuredReport& report);

}  // namespace apps
