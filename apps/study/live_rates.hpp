#pragma once
/// What live cells come to on this station, known before anybody sits down.

#include <functional>
#include <set>
#include <vector>

#include "apps/study/check/measured_check.hpp"
#include "apps/study/session_setup.hpp"

namespace apps {

/// Where and how live cells are measured; the display's GL context is current.
struct MeasuringPlace {
  study::Display& display;
  const std::vector<FramedScene>& scenes;  ///< as that display frames them
  double refresh_hz = 0;                   ///< 0: none, or not known
  std::function<void()> each;              ///< called after every frame; may be empty
  std::function<bool(int cell)> anew;      ///< measured also where times are kept; empty: none is
};

struct LiveTimes {
  std::vector<MeasuredStimulus> stimuli;
  std::set<int> kept;  ///< cells whose times are from before
};

/// Runs each live stimulus through a trial, at that display's size and angle, unless it was measured before
/// with this program on this station: what was measured is kept in sim::default_cache_folder(). Says on
/// stderr how long it takes, before it starts. base::Error for a scene, method or n_* that is not there.
LiveTimes measure_live(const study::Protocol& protocol, CellStimuli& stimuli, const MeasuringPlace& place);

/// Measures and judges what a session plays live in real time (else nothing), and tells the rates on stderr.
/// base::Error that names the cells that do not reach their setting, unless accept_slow; none is refused by
/// what was kept from before, when the station may have been busy: that is measured again.
MeasuredReport check_live(const study::Protocol& protocol, SessionSetup& setup, bool accept_slow);

}  // namespace apps
