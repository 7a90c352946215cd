#pragma once
/// The parts of --display window: the participant's window with its pages, and the mouse as gaze.

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "libstudy/console/preflight.hpp"
#include "libstudy/display/gaze.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/runner/run_options.hpp"
#include "libstudy/session/session.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

class HeadsetDisplay;

/// The request at the window, given those of others; see SessionHooks::request.
using WindowRequest = std::function<Request(const std::function<Request()>& others)>;

/// Each part keeps the window alive.
struct WindowParts {
  std::unique_ptr<Display> display;
  std::unique_ptr<Participant> person;  ///< answers if no observer was named
  /// Viewing::gaze for --gaze mouse.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  std::unique_ptr<GazeSource> mouse;  ///< the same, for the record
  WindowRequest request;
  std::function<void(bool reveal)> open_mirror;  ///< for the experimenter; base::Error if there is no room
  /// Seconds since the last key, button or movement of the mouse at the window.
  std::function<std::optional<double>()> idle;
  /// Processes window events while nothing is shown, so that the window does not count as unresponsive.
  std::function<void()> poll;
  ScreenFacts screen;
  base::PictureSize size;  ///< of the window
};

/// Both functions throw base::Error if there is no window.
WindowParts make_window_parts(const RunOptions& options, const Protocol& protocol);

/// The experimenter's window on the headset's view, open during the returned object's lifetime; see
/// HeadsetMirror.
std::shared_ptr<void> open_headset_mirror(HeadsetDisplay& display, bool reveal);

}  // namespace study
