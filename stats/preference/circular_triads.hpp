#pragma once
/// Consistency of a participant's choices: the number of circular triads (A preferred to B, B to C, and C to
/// A) among all pairs (Kendall and Babington Smith 1940).

#include <span>

#include "stats/result.hpp"

namespace stats {

struct CircularTriads {
  int items = 0;
  int triads = 0;       ///< number of circular triads
  int most = 0;         ///< largest possible number of circular triads
  double expected = 0;  ///< expected number for random choices: a quarter of all triads
  double zeta = 0;      ///< consistency, 1 - triads / most: 1 = no contradiction, 0 = as many as possible
  /// Probability of at most `triads` circular triads under random choices; small if the participant has a
  /// consistent order. Exact up to 7 items, else Kendall's chi-square (1962).
  double p = 0;
  bool exact = true;
};

/// Counts the circular triads of one participant. `wins`: items by items, row after row; exactly one of (i,
/// j) and (j, i) is 1, the other 0. Refused: fewer than three or more than 1,000 items, a pair unanswered or
/// answered twice (the reason names it; items from 1). std::invalid_argument unless there are items^2
/// entries.
Result<CircularTriads> circular_triads(std::span<const double> wins, int items);

struct GroupTriads {
  int participants = 0;
  int items = 0;
  int triads = 0;  ///< sum over the participants
  double expected = 0;
  double mean_zeta = 0;
  double p = 0;  ///< probability of a sum of at most `triads` under random choices: exact convolution up to 7
                 ///< items, else normal
  bool exact = true;
};

/// Combines several participants who all judged the same number of items. Refused: no participants, or
/// different numbers of items.
Result<GroupTriads> group_triads(std::span<const CircularTriads> participants);

}  // namespace stats
