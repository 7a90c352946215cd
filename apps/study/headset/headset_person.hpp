#pragma once
/// A person in a headset: what a session needs of one.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/headset/headset_display.hpp"
#include "apps/study/headset/answer_ways.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/session.hpp"

namespace apps {

/// Each part keeps the pages alive.
struct HeadsetPerson {
  std::unique_ptr<study::Participant> participant;
  std::function<study::Wish(const std::function<study::Wish()>& others)> wish;  ///< see SessionHooks::wish
  std::function<std::optional<double>()> idle;  ///< seconds since a hand or a key was used
  std::function<void()> listen;                 ///< from now on the terminal's keys answer
};

/// What a display must be made with for this person. base::Error where the program has no pages.
HeadsetChoice choice_for_person(const AnswerWays& ways);
/// display and clock, the session's, outlive the parts.
HeadsetPerson make_headset_person(HeadsetDisplay& display, const AnswerWays& ways,
                                  const study::Protocol& protocol, const study::Clock& clock);

}  // namespace apps
