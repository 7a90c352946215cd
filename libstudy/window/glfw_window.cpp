#include "libstudy/window/glfw_window.hpp"

// epoxy must come before GLFW: GLFW then does not include OpenGL's headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <X11/Xlib.h>

#include <atomic>
#include <chrono>
#include <cstdlib>

#include "stats/base/error.hpp"

// Declared here, because GLFW/glfw3native.h would also need the headers of Xrandr.
extern "C" Display* glfwGetX11Display(void);

namespace study {

namespace {

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::atomic<bool> display_lost = false;

[[noreturn]] void fail(const std::string& problem, const std::string& mend) {
  const char* told = nullptr;
  glfwGetError(&told);
  throw base::Error("window", problem + (told ? std::string(": ") + told : std::string()), mend);
}

/// Keeps the program running when the connection to the X server breaks. Xlib would end the program,
/// unless an error handler and an error exit handler are set and both return.
void survive_a_lost_display() {
  display_lost = false;
  Display* display = glfwGetX11Display();
  if (!display) return;
  XSetIOErrorHandler([](Display*) {
    display_lost = true;
    return 0;
  });
  XSetIOErrorExitHandler(
      display, [](Display*, void*) { display_lost = true; }, nullptr);
}

GLFWmonitor* find_monitor(int index, const std::string& mend) {
  int count = 0;
  GLFWmonitor** all = glfwGetMonitors(&count);
  if (index < 0 || index >= count) {
    // vip-study resume opens the window on the recorded monitor and has no option for it.
    const std::string others = count > 1 ? " to " + std::to_string(count - 1) : "";
    fail("there is no monitor " + std::to_string(index) + "; the machine has " + std::to_string(count) +
             " of them",
         count > 0 ? "connect it, or begin a run with --monitor 0" + others : mend);
  }
  return all[index];
}

Monitor describe(GLFWmonitor* monitor) {
  Monitor out;
  if (!monitor) return out;
  out.name = glfwGetMonitorName(monitor);
  if (const GLFWvidmode* mode = glfwGetVideoMode(monitor)) {
    out.width_px = mode->width;
    out.height_px = mode->height;
    out.refresh_hz = mode->refreshRate;
  }
  glfwGetMonitorPhysicalSize(monitor, &out.width_mm, &out.height_mm);
  return out;
}

}  // namespace

GlfwWindow::GlfwWindow(const WindowChoice& choice) : monitor_(choice.monitor), last_input_ns_(steady_ns()) {
  if (!glfwInit()) fail("no display", choice.mend);
  try {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    if (choice.in_background) glfwWindowHint(GLFW_FOCUSED, GLFW_FALSE);
    if (choice.in_background) glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
    const bool whole = choice.width_px == 0 || choice.height_px == 0;
    GLFWmonitor* monitor = whole ? find_monitor(choice.monitor, choice.mend) : nullptr;
    const Monitor mode = describe(monitor);
    if (whole && mode.refresh_hz > 0) glfwWindowHint(GLFW_REFRESH_RATE, static_cast<int>(mode.refresh_hz));
    window_ =
        glfwCreateWindow(whole ? mode.width_px : choice.width_px, whole ? mode.height_px : choice.height_px,
                         choice.title.c_str(), monitor, nullptr);
    if (!window_) fail("no window with OpenGL 4.5", choice.mend);
  } catch (...) {
    glfwTerminate();
    throw;
  }
  survive_a_lost_display();
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    self->note_input();
    if (action == GLFW_PRESS) self->keys_.push_back(key);
    if (action == GLFW_REPEAT) self->repeats_.push_back(key);
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int, int, int) {
    static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window))->note_input();
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    self->note_input();
    if (self->mouse_moved_) self->mouse_moved_(self->place_of(x, y));
  });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* window, int inside) {
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    if (inside == GLFW_FALSE && self->mouse_moved_) self->mouse_moved_({});
  });
  glfwSetWindowIconifyCallback(window_, [](GLFWwindow* window, int minimised) {
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    if (minimised == GLFW_TRUE) self->was_minimised_ = true;
  });
}

void GlfwWindow::note_input() { last_input_ns_ = steady_ns(); }

double GlfwWindow::idle_s() const { return 1e-9 * static_cast<double>(steady_ns() - last_input_ns_); }

GlfwWindow::~GlfwWindow() {
  if (display_lost) return;  // no GLFW calls: the X server is gone
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool GlfwWindow::asked_to_close() const { return glfwWindowShouldClose(window_) != 0; }

bool GlfwWindow::minimised() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE; }

bool GlfwWindow::take_minimised() { return std::exchange(was_minimised_, false) || minimised(); }

GlfwWindow::Size GlfwWindow::size() const {
  Size out;
  glfwGetFramebufferSize(window_, &out.width, &out.height);
  return out;
}

GlfwWindow::Place GlfwWindow::place_of(double x, double y) const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  if (x < 0 || y < 0 || x >= width || y >= height) return {};
  return std::pair{x / width, y / height};
}

GlfwWindow::Place GlfwWindow::mouse_place() const {
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  return place_of(x, y);
}

bool GlfwWindow::mouse(double& x_px, double& y_px) const {
  const Place place = mouse_place();
  if (!place) return false;
  x_px = place->first * size().width;
  y_px = (1 - place->second) * size().height;
  return true;
}

Monitor GlfwWindow::monitor() const {
  GLFWmonitor* mine = glfwGetWindowMonitor(window_);
  return describe(mine ? mine : glfwGetPrimaryMonitor());
}

bool GlfwWindow::display_is_gone() { return display_lost; }

Compositor find_compositor() {
  if (std::getenv("WAYLAND_DISPLAY")) return Compositor::Running;  // Wayland always has a compositor
  Display* display = glfwGetX11Display();
  if (!display || display_lost) return Compositor::Unknown;
  const std::string selection = "_NET_WM_CM_S" + std::to_string(DefaultScreen(display));
  const Atom atom = XInternAtom(display, selection.c_str(), False);
  return XGetSelectionOwner(display, atom) == None ? Compositor::Absent : Compositor::Running;
}

}  // namespace study
