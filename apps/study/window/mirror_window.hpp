#pragma once
/// A second window that shows the experimenter what the participant sees.

#include <array>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "apps/common/window/glfw_window.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

/// On another monitor than the participant's. The participant's thread only copies a picture, small, once it
/// is finished; a thread of its own, in a context that shares the copies, shows the last one, some ten a
/// second, and waits for no screen. What happens at the window counts for nothing.
class MirrorWindow {
 public:
  /// In the thread and with the current context of the participant's window, which outlives it. logged: its
  /// title says so. base::Error
  /// when that window fills the only monitor.
  MirrorWindow(const GlfwWindow& participant, bool logged);
  ~MirrorWindow();
  MirrorWindow(const MirrorWindow&) = delete;
  MirrorWindow& operator=(const MirrorWindow&) = delete;

  /// Takes the picture in a framebuffer object (0: the back buffer, before it is swapped).
  void take(unsigned framebuffer);
  /// The same for one of many: not while an earlier one still waits to be shown.
  void take_some(unsigned framebuffer);
  void take_black();

 private:
  /// What is to be shown: the copy of a picture, whole once `copied` is reached, or black.
  struct Picture {
    int copy = -1;           ///< -1: black
    void* copied = nullptr;  ///< a GLsync
  };

  void leave(Picture picture);
  bool waits();
  void show_all();
  void show(const Picture& picture, const std::array<unsigned, 2>& copies) const;

  GlfwWindow::Size from_, size_;  ///< of the participant's picture and of its copies, px
  GLFWwindow* window_;
  GlfwWindow::Size shown_;  ///< of the mirror's framebuffer, px
  std::array<sim::Offscreen, 2> copies_;
  bool black_ = false;  ///< the last that was taken is

  std::mutex mutex_;
  std::condition_variable changed_;
  bool waiting_ = false, over_ = false;
  Picture next_;      ///< while waiting_
  int reading_ = -1;  ///< the copy that is being shown
  std::thread thread_;
};

}  // namespace apps
