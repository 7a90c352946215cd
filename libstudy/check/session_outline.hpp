#pragma once
/// The parts and duration of a protocol's session, and how evenly its groups of cells are assigned to people.

#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Assumed pace of a participant, for the expected durations of a session.
struct Pace {
  double answer_s = 0;     ///< time to answer one question, s
  double words_per_s = 0;  ///< reading speed, words/s; 0: a text takes only the block's minimum time
  double break_s = 0;      ///< time spent in a break beyond the minimum time, s
};
inline constexpr Pace quick_pace{2, 0, 0}, slow_pace{6, 2, 60};

/// Duration of a session or of a part, s: least at quick_pace, most at slow_pace.
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
  double shown_s = 0;  ///< duration of the design's trials without the time for answers
  Span trials_s;       ///< duration of the design's trials with the time for answers
};

/// The outline of the session at slot 0 of the assignment. Sessions at other slots show other cells but have
/// the same number of trials.
SessionOutline outline_session(const Protocol& protocol);

/// One line about a block: "10 trials: stimulus 30 s, ask 5, rest 30 s".
std::string describe_block(const Protocol& protocol, const BlockOutline& outline);

/// How evenly the assignment spreads sequences over the planned participants. A sequence: the groups of cells
/// that a participant sees, in order of presentation (groups_met()).
struct PlannedBalance {
  int planned = 0;
  int sequences = 1;        ///< number of sequences; 1: groups are not balanced between participants
  int least = 0, most = 0;  ///< fewest and most people per sequence; 0 if drawn at random (PaperRandom)
  /// Largest difference, over all pairs (A, B) of each sequence, between the number of people who see A first
  /// and the number of people who see B first.
  int interval_difference = 0;
  int even = 1;                        ///< any multiple of this number of people is balanced
  int even_below = 0, even_above = 0;  ///< nearest multiples of `even`, <= and >= `planned`; below: 0 if none
};
PlannedBalance check_balance(const Protocol& protocol);

/// The planned balance as one line of text.
std::string describe_balance(const Protocol& protocol, const PlannedBalance& balance);

}  // namespace study
