#pragma once
/// Measures the rates of live cells on this station before a participant begins.

#include <functional>
#include <set>
#include <vector>

#include "libstudy/check/measured_check.hpp"
#include "libstudy/runner/session_setup.hpp"

namespace apps {

/// Where and how live cells are measured; the display's GL context is current.
struct MeasuringPlace {
  study::Display& display;
  const std::vector<study::FramedScene>& scenes;  ///< as the display frames them
  double refresh_hz = 0;                          ///< 0: none or not known
  std::function<void()> each;                     ///< called after every frame; may be empty
  std::function<bool(int cell)> anew;             ///< true: measure even if times are cached; empty: false
};

struct LiveTimes {
  std::vector<study::MeasuredStimulus> stimuli;
  std::set<int> kept;  ///< cells with cached times
};

/// Runs each live stimulus through a trial at the display's size and angle, unless this program measured it
/// before on this station: times are cached in sim::default_cache_folder(). First prints on stderr how long
/// it takes. base::Error for an unknown scene, method or n_*.
LiveTimes measure_live(const study::Protocol& protocol, study::CellStimuli& stimuli,
                       const MeasuringPlace& place);

/// Measures and judges the live cells of a session in real time (else nothing), and prints the rates on
/// stderr. base::Error naming the cells that do not reach their setting, unless accept_slow. Cells that fail
/// by cached times are measured again first, because the station may have been busy then.
study::MeasuredReport check_live(const study::Protocol& protocol, study::SessionSetup& setup,
                                 bool accept_slow);

}  // namespace apps
