#pragma once
/// Turns options into the parts of a session: clock, display, stimuli, participant.

#include <memory>

#include "libstudy/base/clock.hpp"
#include "libstudy/check/measured_check.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/runner/cell_stimuli.hpp"
#include "libstudy/runner/run_options.hpp"
#include "libstudy/runner/session_framing.hpp"
#include "libstudy/runner/window_parts.hpp"
#include "libstudy/session/session.hpp"

namespace study {

/// Owns the parts of a session. The stimuli are destroyed before the display, because they draw in its GL
/// context.
struct SessionSetup {
  bool virtual_clock = false;
  std::unique_ptr<Clock> clock;
  std::unique_ptr<Display> display;
  std::unique_ptr<FeatureSource> features;  ///< picture features for simulated observers; null: a person
  std::unique_ptr<Participant> participant;
  std::unique_ptr<CellStimuli> stimuli;
  std::shared_ptr<GazeSource> gaze;      ///< the recorded gaze source; null: no gaze is recorded
  std::shared_ptr<SlotSource> slots;     ///< source of a headset's frame slots; null: no headset
  std::unique_ptr<GazeTargets> targets;  ///< targets that validate an eye tracker; null: no eye tracker
  WindowRequest request;  ///< adds requests at the window or headset to the experimenter's; may be empty
  /// Seconds since the last input at the window or headset; empty without window and headset.
  std::function<std::optional<double>()> idle;
  /// Makes the terminal's keys answer the pages in a headset; empty without a headset.
  std::function<void()> listen;
  /// Opens the mirror, the experimenter's second window; empty without window and headset. reveal: the mirror
  /// shows stimuli too, not only pages.
  std::function<void(bool reveal)> open_mirror;
  std::function<void()> poll;         ///< handles events of the window; empty: no window
  std::optional<ScreenFacts> screen;  ///< facts of the window's screen; none: no window
  std::string light_patch;            ///< size and place of the patch for a light sensor; empty: none
  std::vector<FramedScene> scenes;    ///< the scenes on the display; empty for --display openxr and none
  std::vector<std::string> warnings;  ///< warnings about clock and database (warn_of_station())
  MeasuredReport rates;               ///< measured rates of live cells; no cells: nothing was measured

  /// Differences between the bakes and what protocol and display require; empty: none. If there are
  /// differences, the session's data are marked as test data.
  std::string departure() const;
};

/// True if participants are asked for permission to record gaze.
bool asks_gaze(const Protocol& protocol);

/// Adds to the experimenter's request that a showing is cut which could not be seen in the headset. A cut
/// turns the headset's slots until pictures can be seen again. The display must outlive the function.
WindowRequest headset_requests(HeadsetDisplay& display);

/// Makes the parts of a session. `ptpe`: text of the PTPE file for temporal acceleration; none: the paper's
/// model. `ptpe_place` names this file in errors, `setting_place` the options' solver settings. base::Error
/// naming a missing, wrong or inconsistent part.
SessionSetup make_session_setup(const RunOptions& options, const Protocol& protocol,
                                const std::optional<std::string>& ptpe, const std::string& ptpe_place,
                                const std::string& setting_place = "--setting");

}  // namespace study
