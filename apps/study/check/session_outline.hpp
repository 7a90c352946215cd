#pragma once
/// What a session of a protocol is made of and how long it takes, and how evenly people are dealt out.

#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// What people need, from quick to slow; only the printed durations depend on it.
struct Pace {
  double answer_s = 0;     ///< for each question
  double words_per_s = 0;  ///< of texts; 0: no more than their least time
  double break_s = 0;      ///< of a break beyond its least time
};
inline constexpr Pace quick_pace{2, 0, 0}, slow_pace{6, 2, 60};

/// Seconds of a session, or of a part of it.
struct Span {
  double least = 0, most = 0;
};

struct BlockOutline {
  const study::Block* block = nullptr;
  int pages = 0, trials = 0;  ///< that a participant meets
  Span seconds;
};

struct SessionOutline {
  std::vector<BlockOutline> blocks;  ///< in the order of the protocol
  int units = 0, trials = 0;
  Span session_s;
  double shown_s = 0;  ///< trials of the design without answers
  Span trials_s;       ///< the same with answers
};

/// Of the plan for slot 0; other slots differ in which cells are shown, not in how many.
SessionOutline outline_session(const study::Protocol& protocol);

/// "10 trials: stimulus 30 s, ask 5, rest 30 s".
std::string describe_block(const study::Protocol& protocol, const BlockOutline& outline);

/// How evenly `planned` people are dealt to what the design balances.
struct Balance {
  int planned = 0;
  int sequences = 1;                   ///< of groups; 1: nothing to deal out
  int least = 0, most = 0;             ///< people that meet a sequence
  int interval_difference = 0;         ///< largest, between the two orders of a pair in a sequence
  int even = 1;                        ///< numbers of people that divide evenly are multiples of this
  int even_below = 0, even_above = 0;  ///< the next such numbers; 0: there is none below
};
Balance check_balance(const study::Protocol& protocol);

/// One line for people.
std::string describe_balance(const study::Protocol& protocol, const Balance& balance);

}  // namespace apps
