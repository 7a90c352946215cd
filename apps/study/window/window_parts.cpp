#include "apps/study/window_parts.hpp"

#include "apps/study/desk/mouse_gaze.hpp"
#include "apps/study/window/participant_window.hpp"
#include "apps/study/window/window_display.hpp"
#include "apps/study/window/window_participant.hpp"
#include "libsim/render/gl_context.hpp"

namespace apps {

namespace {

/// The window tells it of the mouse as long as both live.
class WindowMouse final : public study::GazeSource {
 public:
  explicit WindowMouse(std::shared_ptr<ParticipantWindow> window)
      : window_(std::move(window)), mouse_([this] { return window_->window().mouse_place(); }, clock_) {
    window_->window().on_mouse([this](const MouseGaze::Place& place) { mouse_.moved(place); });
  }
  ~WindowMouse() override { window_->window().on_mouse({}); }
  WindowMouse(const WindowMouse&) = delete;
  WindowMouse& operator=(const WindowMouse&) = delete;

  study::GazeOrigin origin() const override { return mouse_.origin(); }
  void start() override { mouse_.start(); }
  std::vector<study::GazeSample> take() override { return mouse_.take(); }
  void stop() override { mouse_.stop(); }

 private:
  std::shared_ptr<ParticipantWindow> window_;
  study::RealClock clock_;  // a window's session has no other
  MouseGaze mouse_;
};

}  // namespace

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
  parts.size = {window->size().width, window->size().height};
  parts.display = std::move(display);
  parts.person = std::make_unique<WindowParticipant>(window, protocol.blocks.back().id,
                                                     [screen] { screen->find_beat(); });
  parts.gaze = [window](int, int) { return window->mouse(); };
  parts.mouse = std::make_unique<WindowMouse>(window);
  parts.poll = [window] { window->poll(0); };
  parts.idle = [window] { return window->window().idle_s(); };
  parts.wish = [window](const std::function<study::Wish()>& others) { return window->wish(others); };
  return parts;
}

}  // namespace apps
