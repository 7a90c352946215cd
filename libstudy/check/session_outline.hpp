#pragma once
/// The parts and duration of a protocol's session, and the balance of its assignment.

#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// The pace of a participant, quick or slow; it affects only the printed durations.
struct Pace {
  double answer_s = 0;     ///< for each question
  double words_per_s = 0;  ///< for reading texts; 0: only their least time
  double break_s = 0;      ///< in a break beyond its least time
};
inline constexpr Pace quick_pace{2, 0, 0}, slow_pace{6, 2, 60};

/// Seconds of a session, or of a part of it.
struct Span {
  double least = 0, most = 0;
};

struct BlockOutline {
  const Block* block = nullptr;
  int pages = 0, trials = 0;  ///< per participant
  Span seconds;
};

struct SessionOutline {
  std::vector<BlockOutline> blocks;  ///< in the order of the protocol
  int units = 0, trials = 0;
  Span session_s;
  double shown_s = 0;  ///< duration of the design's trials without answers
  Span trials_s;       ///< the same with answers
};

/// The outline of slot 0; other slots show other cells, but equally many.
SessionOutline outline_session(const Protocol& protocol);

/// "10 trials: stimulus 30 s, ask 5, rest 30 s".
std::string describe_block(const Protocol& protocol, const BlockOutline& outline);

/// PlannedBalance of the assignment for `planned` people.
struct PlannedBalance {
  int planned = 0;
  int sequences = 1;                   ///< of groups; 1: nothing to balance
  int least = 0, most = 0;             ///< fewest and most people per sequence
  int interval_difference = 0;         ///< largest difference between the two orders of a pair in a sequence
  int even = 1;                        ///< a multiple of this many people is balanced
  int even_below = 0, even_above = 0;  ///< the next such numbers; 0 if there is none below
};
PlannedBalance check_balance(const Protocol& protocol);

/// The balance as one line of text.
std::string describe_balance(const Protocol& protocol, const PlannedBalance& balance);

}  // namespace study
