#pragma once
/// The states of a session, as the runtime's events tell them.

#include <string>
#include <vector>

#include "apps/common/headset/events.hpp"
#include "apps/common/headset/runtime_clock.hpp"
#include "apps/common/headset/session_handle.hpp"

namespace apps {

/// Begins and ends the session where the specification has it so.
class Lifecycle {
 public:
  Lifecycle(const SessionHandle& session, RuntimeClock& clock);
  HeadsetState state() const { return state_; }
  /// Between READY and STOPPING: frames must come.
  bool running() const { return running_; }
  /// Takes in all events that wait; those that are not known are ignored. Not between begin and end of a
  /// frame.
  std::vector<HeadsetEvent> poll();
  /// Asks for STOPPING, and EXITING behind it. Only while running.
  void request_exit() const;

 private:
  void take(const XrEventDataBuffer& event, std::vector<HeadsetEvent>& out);
  void enter(XrSessionState state, std::vector<HeadsetEvent>& out);

  const SessionHandle& session_;
  RuntimeClock& clock_;
  HeadsetState state_ = HeadsetState::Unknown;
  bool running_ = false;
};

}  // namespace apps
