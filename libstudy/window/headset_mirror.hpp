#pragma once
/// A window that shows the experimenter the view of a person in a headset.

#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "libstudy/headset/headset_display.hpp"

namespace study {

/// Shows the middle of the left eye's view, at most ten times a second. A separate thread draws the view in
/// an OpenGL context that shares the headset's pictures, reads the pixels back and shows them in the window.
/// The window has a second context, because the headset's OpenGL may be on another display or device. The
/// session's thread does not wait while the mirror draws. A GPU draws for one context at a time, so that a
/// frame of the headset may wait until one strip of the mirror's picture is drawn (mirror_picture.cpp).
class HeadsetMirror {
 public:
  /// Call it on the display's thread; the display must outlive the mirror. reveal: shows stimuli too;
  /// otherwise stimuli are black. base::Error if no window can be opened.
  HeadsetMirror(HeadsetDisplay& display, bool reveal);
  ~HeadsetMirror();
  HeadsetMirror(const HeadsetMirror&) = delete;
  HeadsetMirror& operator=(const HeadsetMirror&) = delete;

 private:
  void run(std::promise<void> opened);
  bool wait(std::chrono::steady_clock::duration time);

  HeadsetDisplay& display_;
  bool reveal_;
  sim::GlContext pictures_;  ///< shares the headset's pictures; current only while the mirror draws
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace study
