#include "libstudy/runner/window_parts.hpp"

// epoxy must come before GLFW: GLFW then does not include OpenGL's headers.
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <GLFW/glfw3.h>

#include <memory>
#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/console/preflight.hpp"
#include "libstudy/console/refresh.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/pages/gui/pages.hpp"
#include "libstudy/pages/mouse_gaze.hpp"
#include "libstudy/pages/window/participant_window.hpp"
#include "libstudy/window/headset_mirror.hpp"

namespace study {

namespace {

/// The participant's window as a display of stimuli. Draws off-screen and shows a frame by a buffer swap that
/// waits for the screen.
///
/// Its timing evidence is the submission time (grade D), because the screen does not report when it showed a
/// frame. The predicted display time is the next beat, the instant at which the screen takes over a picture
/// (refresh.hpp). find_beat() measures the beat before a trial. Stimuli that drew on the display must be
/// destroyed before the display.
class WindowDisplay final : public Display {
 public:
  /// Measures the refresh with 120 swaps of a black window (2 s at 60 Hz). The session's clock must be the
  /// real clock.
  explicit WindowDisplay(std::shared_ptr<ParticipantWindow> window);

  std::string description() const override;
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  /// Nominal refresh rate, Hz; 0 if swaps do not wait for the screen.
  double refresh_hz() const override { return refresh_.nominal_hz; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Measures the screen's beat (the instant of a refresh) again, with ten swaps of a black window.
  /// Predictions then do not depend on the beat's drift since the start. Returns at once if swaps do not wait
  /// for the screen.
  void find_beat();
  /// Draws off-screen, copies the picture to the window's back buffer and waits until the GPU has finished.
  /// present() is then only a swap, and a slow picture counts as late.
  void render(Stimulus& stimulus) override;
  /// Shows the picture. gpu_done_ns is the time at which the picture was ready, before its submission.
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override;

  ScreenFacts facts() const;

 private:
  std::vector<std::int64_t> swap_black(int swaps);

  std::shared_ptr<ParticipantWindow> window_;
  RealClock clock_;
  sim::Offscreen picture_;
  Monitor monitor_;
  std::string device_;  ///< name of the OpenGL device
  MeasuredRefresh refresh_;
  std::int64_t ready_ns_ = -1;
};

constexpr int measured_swaps = 120, queued_swaps = 4, beat_swaps = 6;

std::string describe(const Monitor& monitor) {
  return fmt::format("monitor '{}' {}x{}", monitor.name, monitor.width_px, monitor.height_px);
}

WindowDisplay::WindowDisplay(std::shared_ptr<ParticipantWindow> window)
    : window_(std::move(window)),
      picture_(window_->size().width, window_->size().height),
      monitor_(window_->window().monitor()),
      device_(sim::gl_description()),
      refresh_(judge_swaps(swap_black(measured_swaps), monitor_.refresh_hz)) {}

std::vector<std::int64_t> WindowDisplay::swap_black(int swaps) {
  std::vector<std::int64_t> returns;
  for (int i = 0; i < swaps; ++i) {
    window_->show_black();
    glFinish();  // many drivers return from a swap before the screen takes over the picture
    returns.push_back(clock_.now_ns());
    window_->poll(0);
  }
  return returns;
}

double WindowDisplay::measured_hz() const { return refresh_.in_effect ? 1e9 / refresh_.period_ns : 0; }

std::int64_t WindowDisplay::first_onset(std::int64_t earliest_ns) const {
  return between_beats(refresh_, earliest_ns);
}

/// Ignores the first swaps, which fill the queue of pictures and return at once.
void WindowDisplay::find_beat() {
  if (!refresh_.in_effect) return;
  const auto returns = swap_black(queued_swaps + beat_swaps);
  refresh_.beat_ns = beat_of(std::span(returns).last(beat_swaps), refresh_.period_ns);
}

ScreenFacts WindowDisplay::facts() const {
  ScreenFacts facts;
  facts.reported_hz = monitor_.refresh_hz;
  facts.measured_hz = measured_hz();
  const Compositor compositor = find_compositor();
  if (compositor != Compositor::Unknown) facts.compositor = compositor == Compositor::Running;
  facts.software_gl = sim::gl_is_software();
  return facts;
}

std::string WindowDisplay::description() const {
  return "window " + std::to_string(picture_.width()) + "x" + std::to_string(picture_.height()) + ", " +
         describe(monitor_) + ", " + refresh_.finding + ", " + device_;
}

void WindowDisplay::render(Stimulus& stimulus) {
  stimulus.draw({picture_.framebuffer(), picture_.width(), picture_.height()});
  glDisable(GL_SCISSOR_TEST);
  glBlitNamedFramebuffer(picture_.framebuffer(), 0, 0, 0, picture_.width(), picture_.height(), 0, 0,
                         picture_.width(), picture_.height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
  const GLsync done = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  constexpr GLuint64 patience_ns = 100'000'000;
  while (glClientWaitSync(done, GL_SYNC_FLUSH_COMMANDS_BIT, patience_ns) == GL_TIMEOUT_EXPIRED)
    window_->poll(0);
  glDeleteSync(done);
  ready_ns_ = clock_.now_ns();
}

PresentTimes WindowDisplay::present(std::int64_t scheduled_ns, Clock& clock) {
  clock.wait_until(scheduled_ns);
  PresentTimes times;
  times.gpu_done_ns = ready_ns_;
  times.submitted_ns = clock.now_ns();
  times.predicted_display_ns = next_beat(refresh_, times.submitted_ns);
  glfwSwapBuffers(window_->window().get());
  window_->poll(0);
  window_->mirror(picture_.framebuffer());
  return times;
}

/// Owns the window and its pages. A shared pointer to either of the two keeps the other alive.
struct WindowPages {
  explicit WindowPages(const ParticipantWindowOptions& options, const std::string& language)
      : window(options), pages(window, language, clock) {}
  RealClock clock;  // sessions in a window always use the real clock
  ParticipantWindow window;
  Pages pages;
};

/// Gaze source that receives the mouse movements of the participant's window during its lifetime.
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
  WindowDisplay* const screen = display.get();  // SessionSetup destroys the person before the display
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
