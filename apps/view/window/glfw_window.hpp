#pragma once
/// A GLFW window with a current OpenGL 4.5 context.

#include <string>
#include <utility>
#include <vector>

struct GLFWwindow;

namespace apps {

class GlfwWindow {
 public:
  /// base::Error when there is no display or no such context on it.
  GlfwWindow(int width, int height, const std::string& title);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* get() const { return window_; }
  bool asked_to_close() const;
  /// Of the framebuffer, px; 0 when minimised.
  struct Size {
    int width = 0, height = 0;
  };
  Size size() const;
  /// The mouse in px of the framebuffer from its lower left corner; false when it is outside.
  bool mouse(double& x_px, double& y_px) const;
  /// Keys pressed since the last call, as GLFW numbers them: none is lost when frames are slow.
  std::vector<int> take_keys() { return std::exchange(keys_, {}); }

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<int> keys_;
};

}  // namespace apps
