#pragma once
/// A GLFW window with a current OpenGL 4.5 context.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct GLFWwindow;

namespace apps {

struct WindowChoice {
  std::string title;
  int width_px = 0, height_px = 0;  ///< 0: the whole of `monitor`
  int monitor = 0;                  ///< 0: the primary one
  std::string mend{};               ///< what to do where there is no display, for messages
  bool in_background = false;       ///< takes no keyboard from another window when it opens
};

/// A monitor as the system describes it.
struct Monitor {
  std::string name;
  int width_px = 0, height_px = 0;
  double refresh_hz = 0;            ///< whole numbers only; 0: not told
  int width_mm = 0, height_mm = 0;  ///< 0: not told; often wrong
};

class GlfwWindow {
 public:
  /// base::Error when there is no display, no such monitor or no such context on it.
  explicit GlfwWindow(const WindowChoice& choice);
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
  /// A place as shares of the window's width and height from its upper left corner.
  using Place = std::optional<std::pair<double, double>>;
  /// Where the mouse is; none outside.
  Place mouse_place() const;
  /// Called whenever it is taken in that the mouse moved, to a place or out of the window (none).
  void on_mouse(std::function<void(const Place&)> moved) { mouse_moved_ = std::move(moved); }
  /// The mouse in px of the framebuffer from its lower left corner; false when it is outside.
  bool mouse(double& x_px, double& y_px) const;
  /// Keys pressed since the last call, as GLFW numbers them: none is lost when frames are slow. A key held
  /// down counts once.
  std::vector<int> take_keys() { return std::exchange(keys_, {}); }
  /// Seconds since the last key, button or movement of the mouse, or since the window was opened. Any thread.
  double idle_s() const;
  /// Whether it was minimised at any time since the last call, or is now: nobody saw what was drawn then.
  bool take_minimised();
  bool minimised() const;
  /// The monitor it fills or, of a window, the primary one.
  Monitor monitor() const;
  /// The display itself is gone: nothing can be drawn any more.
  static bool display_is_gone();

 private:
  Place place_of(double x, double y) const;
  void note_input();

  GLFWwindow* window_ = nullptr;
  int monitor_ = 0;
  std::vector<int> keys_;
  std::function<void(const Place&)> mouse_moved_;
  bool was_minimised_ = false;
  std::atomic<std::int64_t> last_input_ns_;  ///< steady clock
};

/// Whether a compositor stands between windows and the screen. Needs a window that lives.
enum class Compositor { Unknown, Absent, Running };
Compositor find_compositor();

}  // namespace apps
