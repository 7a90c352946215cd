#pragma once
/// What happens to a headset's session.

#include <cstdint>

namespace apps {

/// As in OpenXR's specification.
enum class HeadsetState {
  Unknown,
  Idle,
  Ready,         ///< frames begin
  Synchronized,  ///< frames run, nothing is seen
  Visible,       ///< seen, and without the controllers and the eyes
  Focused,
  Stopping,     ///< frames end: the headset was taken off, or the session leaves
  LossPending,  ///< the session must be made anew
  Exiting,      ///< the session must end, and none must follow by itself
};

/// "focused".
const char* name_of(HeadsetState state);

struct HeadsetEvent {
  enum class Kind {
    State,        ///< `state` was entered
    RuntimeEnds,  ///< the whole runtime goes away at `at_ns`
    Refresh,      ///< the display went from one rate to another, Hz
    Recentred,    ///< the world's origin is another from `at_ns` on
    EventsLost,   ///< some events never came
    Lost,         ///< the session is gone; no slots come until MadeAnew
    MadeAnew,     ///< another session stands in for one that was lost
  };
  Kind kind = Kind::State;
  HeadsetState state = HeadsetState::Unknown;
  double from_hz = 0, to_hz = 0;
  std::int64_t at_ns = -1;  ///< the session's clock; -1: not told
};

}  // namespace apps
