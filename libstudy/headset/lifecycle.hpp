#pragma once
/// Follows the states of an OpenXR session through the runtime's events.

#include <string>
#include <vector>

#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/loader.hpp"
#include "libstudy/headset/session_handle.hpp"

namespace study {

/// Begins the session in the state READY and ends it in the state STOPPING, as the specification requires.
class Lifecycle {
 public:
  Lifecycle(const SessionHandle& session, RuntimeClock& clock);
  HeadsetState state() const { return state_; }
  /// True from READY until STOPPING, LOSS_PENDING or EXITING: the program must run frames.
  bool running() const { return running_; }
  /// Processes all waiting events; unknown events are ignored. Do not call it between begin and end of a
  /// frame.
  std::vector<HeadsetEvent> poll();
  /// Requests the end of the session: the states STOPPING and EXITING follow. Does nothing unless running.
  void request_exit() const;

 private:
  void take(const XrEventDataBuffer& event, std::vector<HeadsetEvent>& out);
  void enter(XrSessionState state, std::vector<HeadsetEvent>& out);

  const SessionHandle& session_;
  RuntimeClock& clock_;
  HeadsetState state_ = HeadsetState::Unknown;
  bool running_ = false;
};

}  // namespace study
