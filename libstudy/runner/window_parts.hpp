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

/// Returns the request that the session must follow (SessionHooks::request): a request at the window or
/// headset, such as a cut because the picture was not seen, or that of `others`, such as the experimenter's.
using WindowRequest = std::function<Request(const std::function<Request()>& others)>;

/// The parts of --display window. The window stays open while any part exists.
struct WindowParts {
  std::unique_ptr<Display> display;
  std::unique_ptr<Participant> person;  ///< the person at the window; unused if a simulated observer answers
  /// The mouse's position in a picture of this width and height, px from its lower left corner; none if
  /// outside. Used as Viewing::gaze for --gaze mouse.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  std::unique_ptr<GazeSource> mouse;  ///< source of the mouse positions that are recorded as gaze
  WindowRequest request;
  /// Opens the mirror, the experimenter's second window. reveal: the mirror shows stimuli too, not only
  /// pages. base::Error if the window cannot be opened.
  std::function<void(bool reveal)> open_mirror;
  /// Seconds since the last key, button or movement of the mouse at the window.
  std::function<std::optional<double>()> idle;
  /// Processes window events while nothing is shown, so that the window does not count as unresponsive.
  std::function<void()> poll;
  ScreenFacts screen;
  base::PictureSize size;  ///< size of the window
};

/// make_window_parts() and open_headset_mirror() throw base::Error if no window can be opened.
WindowParts make_window_parts(const RunOptions& options, const Protocol& protocol);

/// Opens a window in which the experimenter sees the headset's picture; see HeadsetMirror. reveal: the window
/// shows stimuli too; otherwise stimuli are black. The window stays open as long as the returned object
/// exists.
std::shared_ptr<void> open_headset_mirror(HeadsetDisplay& display, bool reveal);

}  // namespace study
