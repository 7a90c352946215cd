#include "libstudy/pages/window/window_display.hpp"

// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <GLFW/glfw3.h>

#include <vector>

#include "libsim/render/gl_context.hpp"

namespace study {

namespace {

constexpr int measured_swaps = 120, queued_swaps = 4, beat_swaps = 6;

std::string describe(const Monitor& monitor) {
  return fmt::format("monitor '{}' {}x{}", monitor.name, monitor.width_px, monitor.height_px);
}

}  // namespace

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
    glFinish();  // many drivers return from a swap before the screen has taken the picture
    returns.push_back(clock_.now_ns());
    window_->poll(0);
  }
  return returns;
}

double WindowDisplay::measured_hz() const { return refresh_.in_effect ? 1e9 / refresh_.period_ns : 0; }

std::int64_t WindowDisplay::first_onset(std::int64_t earliest_ns) const {
  return between_beats(refresh_, earliest_ns);
}

/// Skips the first swaps, which fill the queue of pictures and return at once.
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

}  // namespace study
