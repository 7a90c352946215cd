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
  int width_px = 0, height_px = 0;  ///< 0: the window fills `monitor`
  int monitor = 0;                  ///< index; 0: the primary monitor
  std::string mend{};               ///< remedy in the error text if no window can be opened
  bool in_background = false;       ///< true: opens without taking the keyboard focus
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
  /// base::Error if there is no display, no such monitor, or no OpenGL 4.5.
  explicit GlfwWindow(const WindowChoice& choice);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* get() const { return window_; }
  bool asked_to_close() const;
  /// Size of the framebuffer, px; may be 0 if minimised.
  struct Size {
    int width = 0, height = 0;
  };
  Size size() const;
  /// A position as fractions of the window's width and height from its upper left corner.
  using Place = std::optional<std::pair<double, double>>;
  /// Position of the mouse; none outside the window.
  Place mouse_place() const;
  /// Sets the function that is called when the mouse moves. Its argument is the position of the mouse, or
  /// none when the mouse leaves the window.
  void on_mouse(std::function<void(const Place&)> moved) { mouse_moved_ = std::move(moved); }
  /// Writes the position of the mouse, px from the lower left corner of the framebuffer. Returns false if the
  /// mouse is outside the window.
  bool mouse(double& x_px, double& y_px) const;
  /// GLFW codes of the keys pressed since the last call, also of short presses during a slow frame. A key
  /// held down counts once.
  std::vector<int> take_keys() { return std::exchange(keys_, {}); }
  /// GLFW codes that the keyboard repeated since the last call, for keys held down.
  std::vector<int> take_repeats() { return std::exchange(repeats_, {}); }
  /// Seconds since the last key, mouse button or mouse movement, or since the window was opened. Callable
  /// from any thread.
  double idle_s() const;
  /// True if the window is minimised, or was minimised at any time since the last call: the participant could
  /// not see it then.
  bool take_minimised();
  bool minimised() const;
  /// The monitor that a full-screen window fills; the primary monitor if the window is not full-screen.
  Monitor monitor() const;
  /// True if the connection to the display is lost: nothing can be drawn any more.
  static bool display_is_gone();

 private:
  Place place_of(double x, double y) const;
  void note_input();

  GLFWwindow* window_ = nullptr;
  int monitor_ = 0;
  std::vector<int> keys_, repeats_;
  std::function<void(const Place&)> mouse_moved_;
  bool was_minimised_ = false;
  std::atomic<std::int64_t> last_input_ns_;  ///< steady clock
};

/// Whether a compositor runs, the program that combines all windows into the picture on the screen.
/// find_compositor() needs an open window.
enum class Compositor { Unknown, Absent, Running };
Compositor find_compositor();

}  // namespace study
