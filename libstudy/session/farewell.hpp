#pragma once
/// What a participant is told and asked once a session has ended before its last unit.

#include <span>

#include "libstudy/session/questioning.hpp"

namespace study {

/// Call it when the end is committed; `left`: units that are not done. Refused and ruled out: a page of
/// thanks. Stopped: it is over, rest until well; where something was shown, the last page of the SSQ that was
/// planned after it, if they wish; keep or delete what was given, which becomes an event (withdrawal_wish);
/// thanks. Whoever left is told nothing. What the experimenter wishes no longer matters but Wish::Stop, which
/// skips the rest of it.
void say_farewell(const Running& run, Questioning& questioning, const Ending& ending,
                  std::span<const OpenUnit> left);

}  // namespace study
