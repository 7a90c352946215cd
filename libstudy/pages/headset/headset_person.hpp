#pragma once
/// Makes the parts that a session needs for a person in a headset.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "libstudy/base/clock.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/session.hpp"

namespace study {

/// The parts of a session with a person in a headset. Each part shares ownership of the pages.
struct HeadsetPerson {
  std::unique_ptr<Participant> participant;
  /// For SessionHooks::request: the request of `others`, or one to cut the trial or to end the session that
  /// the participant or the headset causes.
  std::function<Request(const std::function<Request()>& others)> request;
  std::function<std::optional<double>()> idle;  ///< seconds since the last input by hand or key
  std::function<void()> listen;                 ///< call it to answer with keys of the terminal from then on
};

/// The choice of page size and, for ways.dwell, of eye tracking, with which to make the display. base::Error
/// if the program was built without pages.
HeadsetChoice choice_for_person(const AnswerWays& ways);
/// Makes the parts. display and clock are those of the session and must outlive the parts.
HeadsetPerson make_headset_person(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol,
                                  const Clock& clock);

}  // namespace study
