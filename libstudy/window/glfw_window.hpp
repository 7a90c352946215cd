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

namespace study {

struct WindowChoice {
  std::string title;
  int width_px = 0, height_px = 0;  ///< 0: all of `monitor`
  int monitor = 0;                  ///< 0: the primary one
  std::string mend{};               ///< remedy for messages if there is no display
  bool in_background = false;       ///< does not take the keyboard focus when it opens
};

/// A monitor as the system describes it.
struct Monitor {
  std::string name;
  int width_px = 0, height_px = 0;
  double refresh_hz = 0;            ///< whole numbers only; 0: unknown
  int width_mm = 0, height_mm = 0;  ///< 0: unknown; often wrong
};

class GlfwWindow {
 public:
  /// base::Error if there is no display, no such monitor, or no such context.
  explicit GlfwWindow(const WindowChoice& choice);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* get() const { return window_; }
  bool asked_to_close() const;
  /// Size of the framebuffer, px; 0 if minimised.
  struct Size {
    int width = 0, height = 0;
  };
  Size size() const;
  /// A position as fractions of the window's width and height from its upper left corner.
  using Place = std::optional<std::pair<double, double>>;
  /// Position of the mouse; none outside the window.
  Place mouse_place() const;
  /// Sets the function to call when the mouse moves, with its position, or none when it leaves the window.
  void on_mouse(std::function<void(const Place&)> moved) { mouse_moved_ = std::move(moved); }
  /// Position of the mouse in px of the framebuffer from its lower left corner; false if it is outside.
  bool mouse(double& x_px, double& y_px) const;
  /// GLFW key codes pressed since the last call; none is lost when frames are slow. A key held down counts
  /// once.
  std::vector<int> take_keys() { return std::exchange(keys_, {}); }
  /// Seconds since the last key, button or movement of the mouse, or since the window was opened. Any thread.
  double idle_s() const;
  /// True if it is minimised, or was at any time since the last call: what was drawn then was not seen.
  bool take_minimised();
  bool minimised() const;
  /// The monitor that it fills or, if it is a window, the primary one.
  Monitor monitor() const;
  /// True if the connection to the display is lost: nothing can be drawn any more.
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

/// Whether a compositor is between windows and the screen. find_compositor() needs an open window.
enum class Compositor { Unknown, Absent, Running };
Compositor find_compositor();

}  // namespace study
