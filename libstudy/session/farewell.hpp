#pragma once
/// The pages that a participant sees after a session ended before its last unit.

#include <span>

#include "libstudy/session/questioning.hpp"

namespace study {

/// Shows the pages of an ending that is committed. `left`: units that are not done.
///
/// - Refused, NotEligible: a page of thanks.
/// - Stopped: a page, for at least 60 s if a stimulus was shown. Then, if a stimulus was shown, the offer to
/// answer
///   the last SSQ page in `left`. Then, if answers are stored, the choice to keep or delete them; "delete"
///   logs a withdrawal_request. At the end a page of thanks.
/// - DroppedOut: no page.
///
/// Request::Stop skips the remaining pages. Other requests of the experimenter have no effect.
void say_farewell(const Running& run, Questioning& questioning, const Ending& ending,
                  std::span<const OpenUnit> left);

}  // namespace study
