#pragma once
/// The states of a session, from the runtime's events.

#include <string>
#include <vector>

#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/loader.hpp"
#include "libstudy/headset/session_handle.hpp"

namespace study {

/// Begins and ends the session at the states that the specification names.
class Lifecycle {
 public:
  Lifecycle(const SessionHandle& session, RuntimeClock& clock);
  HeadsetState state() const { return state_; }
  /// True between READY and STOPPING: frames must be run.
  bool running() const { return running_; }
  /// Processes all waiting events and ignores unknown ones. Do not call it between begin and end of a frame.
  std::vector<HeadsetEvent> poll();
  /// Asks for STOPPING and then EXITING. Does nothing unless running.
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
