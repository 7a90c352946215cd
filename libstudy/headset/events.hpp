#pragma once
/// States and events of a headset's session.

#include <cstdint>

namespace study {

/// As in OpenXR's specification.
enum class HeadsetState {
  Unknown,
  Idle,
  Ready,         ///< frames begin
  Synchronized,  ///< frames run, but nothing is seen
  Visible,       ///< pictures are seen, but there is no input from controllers and eyes
  Focused,
  Stopping,     ///< frames end: the headset was taken off, or the session is about to end
  LossPending,  ///< the session must be made again
  Exiting,      ///< the session must end, and no new one may start by itself
};

/// "focused".
const char* name_of(HeadsetState state);

struct HeadsetEvent {
  enum class Kind {
    State,        ///< `state` was entered
    RuntimeEnds,  ///< the whole runtime shuts down at `at_ns`
    Refresh,      ///< the display changed its rate, Hz
    Recentred,    ///< the world's origin moves at `at_ns`
    EventsLost,   ///< some events were dropped
    Lost,         ///< the session is gone; no slots come until MadeAnew
    MadeAnew,     ///< a new session replaces a lost one
  };
  Kind kind = Kind::State;
  HeadsetState state = HeadsetState::Unknown;
  double from_hz = 0, to_hz = 0;
  std::int64_t at_ns = -1;  ///< the session's clock; -1: not reported
};

}  // namespace study
