#pragma once
/// Staircases: each stimulus is computed from the previous stimuli and the responses to them.

#include <optional>
#include <span>
#include <vector>

namespace stats {

/// Rules of a track, the sequence of stimulus values. Positive responses (detected, correct) move the track
/// down, negative ones move it up.
struct StaircaseRules {
  double start = 0;
  double lowest = 0, highest = 0;  ///< the track stays within these values
  /// Transformed up-down rule (Levitt 1971): this many positive responses in a row move the track one step
  /// down, this many negative ones in a row one step up. The values 2 and 1 converge to the stimulus with
  /// 70.7 % positive responses, 3 and 1 to 79.4 %, 1 and 1 to 50 %.
  int down_after = 1, up_after = 1;
  /// steps[r] is the size of a step after r reversals; the last size holds for all further reversals. Not
  /// empty, each above 0.
  std::vector<double> steps{1};
  /// Size of an upward step relative to a downward one, above 0. With down_after = up_after = 1 this is the
  /// weighted rule (Kaernbach 1991): the track converges to the stimulus whose share of positive responses is
  /// up_ratio / (1 + up_ratio), which is 75 % for 3.
  double up_ratio = 1;
  /// True: the steps multiply the stimulus by 10^(step / 20), so steps are in decibels.
  bool decibels = false;
  /// Until the first reversal every response moves the track, as in a 1-up 1-down rule.
  bool fast_start = false;

  /// The track ends when both numbers are reached. If both are 0, it never ends.
  int trials = 0;     ///< least number of responses
  int reversals = 0;  ///< least number of reversals
};

/// The share of positive responses to which the track converges for a smooth psychometric function:
/// 0.5^(1/down_after) for up_after = up_ratio = 1 (Levitt 1971); up_ratio / (1 + up_ratio) for down_after =
/// up_after = 1 (Kaernbach 1991). Empty for other rules.
std::optional<double> target_share(const StaircaseRules& rules);

/// State of a track, rebuilt from its responses.
struct StaircaseTrack {
  std::vector<double> stimuli;  ///< stimuli of the responses, then the next stimulus unless `ended`
  std::vector<int> reversals;   ///< indices of responses at which the direction turned
  bool ended = false;
};

/// Replays the rules on responses (true: positive). A pure function, so a resumed session continues with the
/// same stimuli. std::invalid_argument for rules that are out of range.
StaircaseTrack replay_staircase(const StaircaseRules& rules, std::span<const bool> positive);

/// Mean of the stimuli at the reversals after the first `skip`; the geometric mean under `decibels`. If the
/// number of these reversals is odd, the first of them is left out too, because Levitt (1971) averages an
/// even number. Empty if fewer than two are left.
std::optional<double> reversal_mean(const StaircaseRules& rules, const StaircaseTrack& track, int skip);

}  // namespace stats
