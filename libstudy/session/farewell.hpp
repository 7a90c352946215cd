#pragma once
/// The pages that a participant sees after a session ended before its last unit.

#include <span>

#include "libstudy/session/questioning.hpp"

namespace study {

/// Call it once the end is committed; `left`: units that are not done. Refused and NotEligible: a page of
/// thanks. Stopped: a page, which lasts at least 60 s if a stimulus was shown; after a shown stimulus, an
/// offer to answer the last SSQ page in `left`; if answers are stored, a choice to keep or delete the data
/// (delete logs withdrawal_request); thanks. DroppedOut: nothing. Request::Stop skips the remaining pages;
/// other requests of the experimenter have no effect.
void say_farewell(const Running& run, Questioning& questioning, const Ending& ending,
                  std::span<const OpenUnit> left);

}  // namespace study
