#pragma once
/// The participant's window as a surface for pages.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/pages/gui/page_surface.hpp"
#include "libstudy/pages/page.hpp"
#include "libstudy/pages/window/mirror_window.hpp"
#include "libstudy/window/glfw_window.hpp"

namespace study {

/// Converts newly pressed buttons of any gamepad to events of a page.
class Gamepad {
 public:
  /// Events of the buttons and the two triggers that were pressed since the last call. The direction pad
  /// sends arrow keys, which repeat while it is held, and A sends Enter. B and the left shoulder button go to
  /// the previous question, the right shoulder button to the next. The events of other buttons and of the
  /// triggers have no key.
  std::vector<PageEvent> take();
  /// Ignores buttons that are held down now.
  void forget() { take(); }

 private:
  static constexpr std::size_t buttons = 17;          ///< those of GLFW, then the left and the right trigger
  std::array<std::array<bool, buttons>, 16> down_{};  ///< [joystick][button]
  std::int64_t repeat_ns_ = 0;  ///< time at which a held direction pad repeats its key, on GLFW's clock
};

struct ParticipantWindowOptions {
  int width_px = 0, height_px = 0;  ///< 0: the window fills the monitor
  int monitor = 0;
  PageCharacters characters{};  ///< of all pages
};

/// The window in which a participant sees pages and stimuli. All calls come from the thread that made it. Esc
/// opens the stop dialog. A minimised window counts as not seen.
class ParticipantWindow final : public PageSurface {
 public:
  /// base::Error if there is no display, or no OpenGL 4.5 on the display.
  explicit ParticipantWindow(const ParticipantWindowOptions& options);

  Gui& gui() override { return gui_; }
  /// Throws base::Error if the window was closed or the X server is gone, and study::Stopped if the window
  /// was closed after the session was over.
  void poll(double wait_s) override;
  std::vector<PageEvent> take_events() override;
  void forget_input() override;
  void show() override;
  void show_black() override;
  void show_cursor(bool shown) override;
  std::optional<CutCause> take_unseen() override {
    return window_.take_minimised() ? std::optional(CutCause::Minimised) : std::nullopt;
  }
  bool unseen() const override { return window_.minimised(); }
  void set_over(bool over) override { over_ = over; }

  /// Opens a mirror of the participant's pages for the experimenter. reveal: the mirror also shows stimuli;
  /// otherwise they are black. base::Error as in MirrorWindow.
  void open_mirror(bool reveal);
  /// Copies the picture of a stimulus in this OpenGL framebuffer object to the mirror, if the mirror reveals
  /// stimuli.
  void mirror(unsigned framebuffer);

  GlfwWindow& window() { return window_; }
  /// Size of the framebuffer when the window was opened, px. The size must not change.
  GlfwWindow::Size size() const { return size_; }
  /// Position of the mouse, px from the lower left corner of the framebuffer; none if outside the window.
  std::optional<std::pair<double, double>> mouse() const;

 private:
  /// Connects the window's mouse and keys to Dear ImGui. Made after gui_ and destroyed before gui_.
  struct Backend {
    explicit Backend(GLFWwindow* window);
    ~Backend();
    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;
  };

  GlfwWindow window_;
  GlfwWindow::Size size_;
  Gui gui_;
  Backend backend_;
  Gamepad gamepad_;
  unsigned buttons_ = 0;  ///< a bit for each mouse button that was down at the last call of take_events()
  bool over_ = false;
  std::unique_ptr<MirrorWindow> mirror_;
  bool mirror_reveals_ = false;
};

}  // namespace study
