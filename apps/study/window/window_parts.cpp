#include "apps/study/window_parts.hpp"

#include "apps/study/window/participant_window.hpp"
#include "apps/study/window/window_display.hpp"
#include "apps/study/window/window_participant.hpp"
#include "libsim/render/gl_context.hpp"

namespace apps {

WindowParts make_window_parts(const RunOptions& options, const study::Protocol& protocol) {
  ParticipantWindowOptions chosen;
  chosen.width_px = options.width_px;
  chosen.height_px = options.height_px;
  chosen.monitor = options.monitor;
  chosen.language = protocol.language;
  const auto window = std::make_shared<ParticipantWindow>(chosen);
  auto display = std::make_unique<WindowDisplay>(window);

  WindowParts parts;
  WindowDisplay* const screen = display.get();  // outlives the person: see SessionSetup
  parts.screen = display->facts();
  parts.display = std::move(display);
  parts.person = std::make_unique<WindowParticipant>(window, [screen] { screen->find_beat(); });
  parts.gaze = [window](int, int) { return window->mouse(); };
  parts.wish = [window](const std::function<study::Wish()>& others) { return window->wish(others); };
  return parts;
}

}  // namespace apps
