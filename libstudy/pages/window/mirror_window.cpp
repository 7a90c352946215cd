#include "libstudy/pages/window/mirror_window.hpp"

// epoxy must come before GLFW: GLFW then does not include OpenGL's headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr int most_width_px = 640;
constexpr std::chrono::milliseconds between_pictures{100};

GlfwWindow::Size mirror_size(GlfwWindow::Size picture) {
  const int width = std::min(picture.width, most_width_px);
  return {width, std::max(1, picture.height * width / picture.width)};
}

/// A monitor for the mirror: another than the participant's, or the same if the participant's window does not
/// fill it. base::Error if that window fills the only monitor.
GLFWmonitor* experimenters_monitor(GLFWwindow* participant) {
  GLFWmonitor* const filled = glfwGetWindowMonitor(participant);
  GLFWmonitor* const theirs = filled ? filled : glfwGetPrimaryMonitor();
  int count = 0;
  GLFWmonitor** const all = glfwGetMonitors(&count);
  for (int i = 0; i < count; ++i) {
    if (all[i] != theirs) return all[i];
  }
  if (filled)
    throw base::Error("--mirror", "the participant's window fills the only monitor",
                      "connect a second monitor, or give the participant's window a --size");
  return theirs;
}

/// Opens a window in the lower right corner of its monitor, without keyboard focus.
GLFWwindow* open_window(GLFWwindow* participant, GlfwWindow::Size size, const char* title) {
  GLFWmonitor* const monitor = experimenters_monitor(participant);
  glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
  glfwWindowHint(GLFW_FOCUSED, GLFW_FALSE);
  glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* const window = glfwCreateWindow(size.width, size.height, title, nullptr, participant);
  if (!window) throw base::Error("--mirror", "a second window cannot be opened", "leave --mirror out");
  int x = 0, y = 0, width = 0, height = 0;
  glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
  glfwSetWindowPos(window, x + std::max(0, width - size.width), y + std::max(0, height - size.height));
  glfwShowWindow(window);
  return window;
}

GlfwWindow::Size framebuffer_size(GLFWwindow* window) {
  GlfwWindow::Size out;
  glfwGetFramebufferSize(window, &out.width, &out.height);
  return out;
}

}  // namespace

MirrorWindow::MirrorWindow(const GlfwWindow& participant, bool logged)
    : from_(participant.size()),
      size_(mirror_size(from_)),
      window_(open_window(participant.get(), size_,
                          logged ? "vip-study: the participant's view (logged)" : "vip-study: pages")),
      shown_(framebuffer_size(window_)),
      copies_{sim::Offscreen(size_.width, size_.height), sim::Offscreen(size_.width, size_.height)},
      thread_([this] { show_all(); }) {
  take_black();
}

MirrorWindow::~MirrorWindow() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_one();
  thread_.join();
  if (!GlfwWindow::display_is_gone()) glfwDestroyWindow(window_);
}

bool MirrorWindow::waits() {
  const std::lock_guard lock(mutex_);
  return waiting_;
}

void MirrorWindow::take_some(unsigned framebuffer) {
  if (!waits()) take(framebuffer);
}

void MirrorWindow::take(unsigned framebuffer) {
  Picture picture;
  {
    const std::lock_guard lock(mutex_);
    picture.copy = reading_ == 0 ? 1 : 0;
    if (next_.copy == picture.copy) waiting_ = false;  // the waiting copy will be overwritten below
  }
  glDisable(GL_SCISSOR_TEST);
  glBlitNamedFramebuffer(framebuffer, copies_[static_cast<std::size_t>(picture.copy)].framebuffer(), 0, 0,
                         from_.width, from_.height, 0, 0, size_.width, size_.height, GL_COLOR_BUFFER_BIT,
                         GL_LINEAR);
  picture.copied = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();  // submits the fence, for which the mirror's context waits
  black_ = false;
  leave(picture);
}

void MirrorWindow::take_black() {
  if (black_) return;
  black_ = true;
  leave({});
}

void MirrorWindow::leave(Picture picture) {
  {
    const std::lock_guard lock(mutex_);
    std::swap(next_, picture);
    waiting_ = true;
  }
  glDeleteSync(static_cast<GLsync>(picture.copied));  // fence of a picture that was never shown
  changed_.notify_one();
}

void MirrorWindow::show_all() {
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(0);
  std::array<unsigned, 2> copies{};  // contexts share textures, not framebuffers
  glCreateFramebuffers(2, copies.data());
  for (std::size_t i = 0; i < copies.size(); ++i)
    glNamedFramebufferTexture(copies[i], GL_COLOR_ATTACHMENT0, copies_[i].texture(), 0);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return waiting_ || over_; });
    if (over_) break;
    const Picture picture = std::exchange(next_, {});
    waiting_ = false;
    reading_ = picture.copy;
    lock.unlock();
    show(picture, copies);
    lock.lock();
    reading_ = -1;
    changed_.wait_for(lock, between_pictures, [this] { return over_; });
  }
  glDeleteFramebuffers(2, copies.data());
  glfwMakeContextCurrent(nullptr);
}

void MirrorWindow::show(const Picture& picture, const std::array<unsigned, 2>& copies) const {
  if (GlfwWindow::display_is_gone()) return;
  if (picture.copy < 0) {
    constexpr std::array<float, 4> black{0, 0, 0, 1};
    glClearNamedFramebufferfv(0, GL_COLOR, 0, black.data());
  } else {
    const auto copied = static_cast<GLsync>(picture.copied);
    glWaitSync(copied, 0, GL_TIMEOUT_IGNORED);
    glDeleteSync(copied);
    glBlitNamedFramebuffer(copies[static_cast<std::size_t>(picture.copy)], 0, 0, 0, size_.width, size_.height,
                           0, 0, shown_.width, shown_.height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  }
  glfwSwapBuffers(window_);
  glFinish();  // the copy may be overwritten from now on
}

}  // namespace study
