#pragma once
/// Measures the frame rates of live cells on this station before a participant begins. The fluid of a live
/// cell (condition of the design) is computed while it is shown, not read from a bake.

#include <functional>
#include <set>
#include <vector>

#include "libstudy/check/measured_check.hpp"
#include "libstudy/runner/session_setup.hpp"

namespace apps {

/// Display, framing and options for measuring the cells whose fluid is computed live. The display's GL
/// context must be current.
struct MeasuringPlace {
  study::Display& display;
  const std::vector<study::FramedScene>& scenes;  ///< scenes as the display frames them; empty for a headset
  double refresh_hz = 0;                          ///< refresh rate of the display, Hz; 0: none or not known
  std::function<void()> each;                     ///< called after every frame; may be empty
  std::function<bool(int cell)> anew;             ///< true: measure even if times are cached; empty: false
};

struct LiveTimes {
  std::vector<study::MeasuredStimulus> stimuli;
  std::set<int> kept;  ///< cells whose times were read from the cache
};

/// Times the steps of each live stimulus (computed while it is shown) in one trial at the display's size and
/// angle. Uses the times in sim::default_cache_folder() if the same program measured the stimulus on this
/// machine before, except for cells with place.anew. Before measuring, prints on stderr how long it takes at
/// most, without preparing the stimuli. base::Error for an unknown scene, method or n_*.
LiveTimes measure_live(const study::Protocol& protocol, study::CellStimuli& stimuli,
                       const MeasuringPlace& place);

/// Measures and judges the cells of a session whose fluid is computed live, not read from a bake, and prints
/// their rates on stderr. Does nothing on a virtual clock. Unless accept_slow: base::Error for cells that do
/// not reach their setting. Before that error, cells that are too slow by cached times are measured again,
/// because the station may have been busy at the earlier measurement.
study::MeasuredReport check_live(const study::Protocol& protocol, study::SessionSetup& setup,
                                 bool accept_slow);

}  // namespace apps
