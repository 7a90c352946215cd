#include "libstudy/runner/window_parts.hpp"

#include "libsim/render/gl_context.hpp"
#include "libstudy/pages/gui/page_participant.hpp"
#include "libstudy/pages/mouse_gaze.hpp"
#include "libstudy/pages/window/participant_window.hpp"
#include "libstudy/pages/window/window_display.hpp"
#include "libstudy/window/headset_mirror.hpp"

namespace study {

namespace {

/// Owns the window and its pages while either is referenced.
struct WindowPages {
  explicit WindowPages(const ParticipantWindowOptions& options, const std::string& language)
      : window(options), pages(window, language, clock) {}
  RealClock clock;  // sessions in a window always use the real clock
  ParticipantWindow window;
  Pages pages;
};

/// Receives mouse movements from the window during its lifetime.
class WindowMouse final : public GazeSource {
 public:
  explicit WindowMouse(std::shared_ptr<ParticipantWindow> window)
      : window_(std::move(window)), mouse_([this] { return window_->window().mouse_place(); }, clock_) {
    window_->window().on_mouse([this](const MouseGaze::Place& place) { mouse_.moved(place); });
  }
  ~WindowMouse() override { window_->window().on_mouse({}); }
  WindowMouse(const WindowMouse&) = delete;
  WindowMouse& operator=(const WindowMouse&) = delete;

  GazeOrigin origin() const override { return mouse_.origin(); }
  void start() override { mouse_.start(); }
  std::vector<GazeSample> take() override { return mouse_.take(); }
  void stop() override { mouse_.stop(); }

 private:
  std::shared_ptr<ParticipantWindow> window_;
  RealClock clock_;
  MouseGaze mouse_;
};

}  // namespace

WindowParts make_window_parts(const RunOptions& options, const Protocol& protocol) {
  ParticipantWindowOptions chosen;
  chosen.width_px = options.width_px;
  chosen.height_px = options.height_px;
  chosen.monitor = options.monitor;
  chosen.characters = page_characters(protocol);
  const auto both = std::make_shared<WindowPages>(chosen, protocol.language);
  const std::shared_ptr<ParticipantWindow> window(both, &both->window);
  const std::shared_ptr<Pages> pages(both, &both->pages);
  auto display = std::make_unique<WindowDisplay>(window);

  WindowParts parts;
  WindowDisplay* const screen = display.get();  // outlives the person: see SessionSetup
  parts.screen = display->facts();
  parts.size = {window->size().width, window->size().height};
  parts.display = std::move(display);
  parts.person =
      std::make_unique<PageParticipant>(pages, protocol.blocks.back().id, [screen] { screen->find_beat(); });
  parts.gaze = [window](int, int) { return window->mouse(); };
  parts.mouse = std::make_unique<WindowMouse>(window);
  parts.poll = [window] { window->poll(0); };
  parts.idle = [window] { return window->window().idle_s(); };
  parts.open_mirror = [window](bool reveal) { window->open_mirror(reveal); };
  parts.request = [pages](const std::function<Request()>& others) { return pages->request(others); };
  return parts;
}

std::shared_ptr<void> open_headset_mirror(HeadsetDisplay& display, bool reveal) {
  return std::make_shared<HeadsetMirror>(display, reveal);
}

}  // namespace study
