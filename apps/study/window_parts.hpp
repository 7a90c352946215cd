#pragma once
/// What --display window brings: the participant's window with its pages, the mouse as gaze, the console.

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "apps/study/run_options.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/session.hpp"

namespace apps {

struct WindowParts {
  std::unique_ptr<study::Display> display;
  std::unique_ptr<study::Participant> person;  ///< answers where no observer was named
  /// LiveViewing::gaze for --gaze mouse; empty: the middle of the picture.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  study::SessionHooks console;  ///< called beside the program's own
};

/// base::Error where there is no window.
WindowParts make_window_parts(const RunOptions& options, const study::Protocol& protocol);

}  // namespace apps
