#pragma once
/// A second window that shows the participant's view to the experimenter.

#include <array>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "libsim/gl/offscreen.hpp"
#include "libstudy/window/glfw_window.hpp"

namespace study {

/// A mirror on another monitor than the participant's window, or on the same monitor if there is only one and
/// the participant's window does not fill it. The participant's thread only makes a small copy of each
/// finished picture. The mirror's thread has an OpenGL context that shares the copies. It shows the newest
/// copy, at most ten times a second, without waiting for the screen. Input to the mirror's window is ignored.
class MirrorWindow {
 public:
  /// Call it on the thread of the participant's window, with that window's context current. The participant's
  /// window must outlive the mirror. logged: the mirror's title ends in "(logged)". base::Error if the
  /// participant's window fills the only monitor.
  MirrorWindow(const GlfwWindow& participant, bool logged);
  ~MirrorWindow();
  MirrorWindow(const MirrorWindow&) = delete;
  MirrorWindow& operator=(const MirrorWindow&) = delete;

  /// Copies the picture in an OpenGL framebuffer object for the mirror; 0: the back buffer, before the swap.
  void take(unsigned framebuffer);
  /// As take(), for frequent pictures: does nothing while an earlier copy still waits to be shown.
  void take_some(unsigned framebuffer);
  void take_black();

 private:
  /// A picture to show: black, or a copy, which is complete once the fence `copied` is signalled.
  struct Picture {
    int copy = -1;           ///< index in copies_; -1: black
    void* copied = nullptr;  ///< a GLsync
  };

  void leave(Picture picture);
  bool waits();
  void show_all();
  void show(const Picture& picture, const std::array<unsigned, 2>& copies) const;

  GlfwWindow::Size from_, size_;  ///< sizes of the participant's picture and of the copies, px
  GLFWwindow* window_;
  GlfwWindow::Size shown_;  ///< size of the mirror's framebuffer, px
  std::array<sim::Offscreen, 2> copies_;
  bool black_ = false;  ///< the last picture taken is black

  std::mutex mutex_;
  std::condition_variable changed_;
  bool waiting_ = false, over_ = false;
  Picture next_;      ///< picture to show next, while waiting_
  int reading_ = -1;  ///< index of the copy being shown; -1: none
  std::thread thread_;
};

}  // namespace study
