#pragma once
/// A person in a headset: the parts that a session needs.

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

/// The parts; each keeps the pages alive.
struct HeadsetPerson {
  std::unique_ptr<Participant> participant;
  std::function<Request(const std::function<Request()>& others)> request;  ///< see SessionHooks::request
  std::function<std::optional<double>()> idle;  ///< seconds since a hand or a key was used
  std::function<void()> listen;                 ///< takes keys of the terminal as answers from this call on
};

/// The choice with which a display must be made for this person. base::Error if the program has no pages.
HeadsetChoice choice_for_person(const AnswerWays& ways);
/// display and clock are the session's and must outlive the parts.
HeadsetPerson make_headset_person(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol,
                                  const Clock& clock);

}  // namespace study
