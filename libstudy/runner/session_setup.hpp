#pragma once
/// Turns options into the parts of a session: clock, display, stimuli, participant.

#include <memory>

#include "libstudy/base/clock.hpp"
#include "libstudy/check/measured_check.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/runner/cell_stimuli.hpp"
#include "libstudy/runner/run_options.hpp"
#include "libstudy/runner/session_framing.hpp"
#include "libstudy/runner/window_parts.hpp"
#include "libstudy/session/session.hpp"

namespace study {

/// Owns the parts. Stimuli are destroyed before the display whose GL context they draw in.
struct SessionSetup {
  bool virtual_clock = false;
  std::unique_ptr<Clock> clock;
  std::unique_ptr<Display> display;
  std::unique_ptr<FeatureSource> features;  ///< for the frames observer
  std::unique_ptr<Participant> participant;
  std::unique_ptr<CellStimuli> stimuli;
  std::shared_ptr<GazeSource> gaze;             ///< the recorded gaze source; null: no gaze is recorded
  std::shared_ptr<SlotSource> slots;            ///< of a headset, or null
  std::unique_ptr<GazeTargets> targets;         ///< of an eye tracker, or null
  WindowRequest request;                        ///< of the window or the headset, or empty
  std::function<std::optional<double>()> idle;  ///< of the window or the headset, or empty
  std::function<void()> listen;  ///< makes the terminal's keys answer a headset's pages, or empty
  std::function<void(bool reveal)> open_mirror;  ///< of the window or the headset, or empty
  std::function<void()> poll;                    ///< of the window, or empty
  std::optional<ScreenFacts> screen;             ///< of the window, or none
  std::vector<FramedScene> scenes;               ///< as the display frames them; none: nothing is drawn
  std::vector<std::string> warnings;  ///< of clock and database (warn_of_station), for console and log
  MeasuredReport rates;               ///< of live cells on this station; none: nothing was measured

  /// How bakes depart from the protocol and the display; empty: not at all. Data of such sessions are test
  /// data.
  std::string departure() const;
};

/// True if participants are asked for permission to record gaze.
bool asks_gaze(const Protocol& protocol);

/// `ptpe` is the text of the PTPE file, which errors call `ptpe_place`; none: the paper's model drives
/// temporal acceleration. `setting_place` names the options' settings in errors. base::Error naming a
/// missing, wrong or inconsistent part.
SessionSetup make_session_setup(const RunOptions& options, const Protocol& protocol,
                                const std::optional<std::string>& ptpe, const std::string& ptpe_place,
                                const std::string& setting_place = "--setting");

}  // namespace study
