#pragma once
/// What live cells come to on this station, known before anybody sits down.

#include <functional>
#include <string>
#include <vector>

#include "apps/study/check/measured_check.hpp"
#include "apps/study/session_setup.hpp"

namespace apps {

/// Where and how live cells are measured; the display's GL context is current.
struct MeasuringPlace {
  study::Display& display;
  const std::vector<FramedScene>& scenes;  ///< as that display frames them
  double refresh_hz = 0;                   ///< 0: none, or not known
  bool anew = false;                       ///< also what is kept from before
  std::function<void()> each;              ///< called after every frame; may be empty
};

/// Runs each live stimulus through a trial, at that display's size and angle, unless it was measured before
/// with this program on this station: what was measured is kept in sim::default_cache_folder(). Says on
/// stderr how long it takes, before it starts. base::Error for a scene, method or n_* that is not there.
std::vector<MeasuredStimulus> measure_live(const study::Protocol& protocol, CellStimuli& stimuli,
                                           const MeasuringPlace& place);

/// Measures and judges what a session plays live in real time (else nothing), and tells the rates on stderr.
/// base::Error that names the cells that do not reach their setting, unless accept_slow.
MeasuredReport check_live(const study::Protocol& protocol, SessionSetup& setup, bool accept_slow);

}  // namespace apps
