#include "apps/view/window/glfw_window.hpp"

// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include "stats/base/error.hpp"

namespace apps {

namespace {

[[noreturn]] void fail(const std::string& problem) {
  const char* told = nullptr;
  glfwGetError(&told);
  throw base::Error("window", problem + (told ? std::string(": ") + told : std::string()),
                    "use --headless --png FOLDER on a machine without a display");
}

}  // namespace

GlfwWindow::GlfwWindow(int width, int height, const std::string& title) {
  if (!glfwInit()) fail("no display");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    glfwTerminate();
    fail("no window with OpenGL 4.5");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    if (action == GLFW_PRESS) self->keys_.push_back(key);
  });
}

GlfwWindow::~GlfwWindow() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool GlfwWindow::asked_to_close() const { return glfwWindowShouldClose(window_) != 0; }

GlfwWindow::Size GlfwWindow::size() const {
  Size out;
  glfwGetFramebufferSize(window_, &out.width, &out.height);
  return out;
}

bool GlfwWindow::mouse(double& x_px, double& y_px) const {
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  if (x < 0 || y < 0 || x >= width || y >= height) return false;
  const double scale = static_cast<double>(size().width) / width;
  x_px = scale * x;
  y_px = scale * (height - y);
  return true;
}

}  // namespace apps
