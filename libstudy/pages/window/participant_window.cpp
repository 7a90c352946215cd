#include "libstudy/pages/window/participant_window.hpp"

// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>

#include "libsim/render/gl_context.hpp"
#include "libstudy/pages/window/page_keys.hpp"
#include "libstudy/session/session.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

WindowChoice as_window(const ParticipantWindowOptions& options) {
  return {"vip-study", options.width_px, options.height_px, options.monitor,
          "use --display headless or none on a machine without a screen"};
}

}  // namespace

ParticipantWindow::Backend::Backend(GLFWwindow* window) { ImGui_ImplGlfw_InitForOpenGL(window, true); }
ParticipantWindow::Backend::~Backend() { ImGui_ImplGlfw_Shutdown(); }

ParticipantWindow::ParticipantWindow(const ParticipantWindowOptions& options)
    : window_(as_window(options)),
      size_(window_.size()),
      gui_(type_for_screen(size_.height), {ImGui_ImplGlfw_NewFrame, [] { return 0U; }}, options.characters),
      backend_(window_.get()) {
  sim::require_gl45();
  show_black();
}

void ParticipantWindow::poll(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  if (GlfwWindow::display_is_gone()) {
    throw base::Error("the participant's window", "the display is gone; all answers given are kept",
                      "bring it back and continue with vip-study resume");
  }
  if (window_.asked_to_close()) {
    if (over_) throw Stopped();
    throw base::Error("the participant's window", "was closed; all answers given are kept",
                      "continue with vip-study resume");
  }
}

void ParticipantWindow::show_cursor(bool shown) {
  glfwSetInputMode(window_.get(), GLFW_CURSOR, shown ? GLFW_CURSOR_NORMAL : GLFW_CURSOR_HIDDEN);
}

void ParticipantWindow::forget_input() {
  glfwPollEvents();
  window_.take_keys();
  window_.take_minimised();
  gamepad_.forget();
}

void ParticipantWindow::show_black() {
  show_cursor(false);
  gui_.begin(colour::black);
  gui_.end();
  glfwSwapBuffers(window_.get());
  if (mirror_) mirror_->take_black();
}

void ParticipantWindow::show() {
  if (mirror_) mirror_->take(0);
  glfwSwapBuffers(window_.get());
}

void ParticipantWindow::open_mirror(bool reveal) {
  mirror_ = std::make_unique<MirrorWindow>(window_, reveal);
  mirror_reveals_ = reveal;
}

void ParticipantWindow::mirror(unsigned framebuffer) {
  if (mirror_ && mirror_reveals_) mirror_->take_some(framebuffer);
}

std::vector<PageEvent> ParticipantWindow::take_events() {
  std::vector<PageEvent> events;
  const bool shift = glfwGetKey(window_.get(), GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
                     glfwGetKey(window_.get(), GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
  for (const int key : window_.take_keys()) events.push_back(event_of(key, shift));
  for (const PageKey key : gamepad_.take()) events.push_back({.key = key, .input = AnswerInput::Gamepad});
  return events;
}

std::optional<std::pair<double, double>> ParticipantWindow::mouse() const {
  double x = 0, y = 0;
  if (!window_.mouse(x, y)) return {};
  return std::pair{x, y};
}

}  // namespace study
