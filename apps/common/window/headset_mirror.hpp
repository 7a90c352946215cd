#pragma once
/// A window that shows the experimenter what somebody in a headset sees.

#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "apps/common/headset/headset_display.hpp"

namespace apps {

/// The middle of the left eye's view, some ten times a second or, where drawing takes long, less often. A
/// thread of its own draws it in a context that shares the headset's pictures, reads it back and shows it:
/// windows share no context with a headset, whose OpenGL may be another display's or another device's. Slots
/// and the session's thread never wait for it.
class HeadsetMirror {
 public:
  /// On the display's thread; the display outlives it. reveal: stimuli are shown too, else they are black.
  /// base::Error where no window can be opened.
  HeadsetMirror(HeadsetDisplay& display, bool reveal);
  ~HeadsetMirror();
  HeadsetMirror(const HeadsetMirror&) = delete;
  HeadsetMirror& operator=(const HeadsetMirror&) = delete;

 private:
  void run(std::promise<void> opened);
  bool wait(std::chrono::steady_clock::duration time);

  HeadsetDisplay& display_;
  bool reveal_;
  sim::GlContext pictures_;  ///< current nowhere, but while a picture is taken
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace apps
