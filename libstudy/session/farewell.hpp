#pragma once
/// The pages that a participant sees after a session ended before its last unit.

#include <span>

#include "libstudy/session/questioning.hpp"

namespace study {

/// Shows the pages of an ending that is committed. `left`: units that are not done.
///
/// - Refused, NotEligible: a page of thanks.
/// - Stopped: a page that asks the participant to rest, for at least 60 s if a stimulus was shown. If a
///   stimulus was shown and `left` has SSQ pages, the participant is then offered the last of them. If
///   answers are stored, the next page asks whether to keep or delete them; "delete" logs a
///   withdrawal_request. The last page thanks the participant.
/// - DroppedOut: no page.
///
/// Request::Stop skips the remaining pages. Other requests of the experimenter have no effect.
void say_farewell(const Running& run, Questioning& questioning, const Ending& ending,
                  std::span<const OpenUnit> left);

}  // namespace study
