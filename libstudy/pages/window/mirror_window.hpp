#pragma once
/// A second window that shows the participant's view to the experimenter.

#include <array>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "libsim/gl/offscreen.hpp"
#include "libstudy/window/glfw_window.hpp"

namespace study {

/// The mirror is on another monitor than the participant's window. The participant's thread only makes a
/// small copy of each finished picture. The mirror's own thread, whose context shares the copies, shows the
/// last one, about ten per second, without waiting for the screen. Input to the window is ignored.
class MirrorWindow {
 public:
  /// Call on the thread and with the current context of the participant's window, which must outlive it.
  /// logged: the title ends in "(logged)". base::Error if that window fills the only monitor.
  MirrorWindow(const GlfwWindow& participant, bool logged);
  ~MirrorWindow();
  MirrorWindow(const MirrorWindow&) = delete;
  MirrorWindow& operator=(const MirrorWindow&) = delete;

  /// Copies the picture in a framebuffer object (0: the back buffer, before the swap).
  void take(unsigned framebuffer);
  /// The same for frequent pictures: skipped while an earlier one still waits to be shown.
  void take_some(unsigned framebuffer);
  void take_black();

 private:
  /// A picture to show: a copy, complete once `copied` is signalled, or black.
  struct Picture {
    int copy = -1;           ///< -1: black
    void* copied = nullptr;  ///< a GLsync
  };

  void leave(Picture picture);
  bool waits();
  void show_all();
  void show(const Picture& picture, const std::array<unsigned, 2>& copies) const;

  GlfwWindow::Size from_, size_;  ///< of the participant's picture and of the copies, px
  GLFWwindow* window_;
  GlfwWindow::Size shown_;  ///< of the mirror's framebuffer, px
  std::array<sim::Offscreen, 2> copies_;
  bool black_ = false;  ///< the last picture taken is black

  std::mutex mutex_;
  std::condition_variable changed_;
  bool waiting_ = false, over_ = false;
  Picture next_;      ///< while waiting_
  int reading_ = -1;  ///< the copy being shown
  std::thread thread_;
};

}  // namespace study
