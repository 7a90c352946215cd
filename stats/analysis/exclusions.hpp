#pragma once
/// Exclusions by rules fixed beforehand. What comes in tells neither method nor scene nor n_*, so no rule can
/// look at a contrast of interest.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"

namespace stats {

enum class TrialTiming { Unjudged, Pass, Degraded, Fail };

/// One planned trial as the rules may see it.
struct TrialRecord {
  static constexpr double unanswered = std::numeric_limits<double>::quiet_NaN();

  std::string participant;
  int visit = 1;
  int position = 0;                            ///< 0-based
  TrialTiming timing = TrialTiming::Unjudged;  ///< the worse of a pair's two
  std::string timing_reason;                   ///< why it is not a pass
  bool interrupted = false;                    ///< left out by the protocol's policy after an interruption
  std::string by_experimenter;                 ///< the reason given; empty: not excluded by hand
  double answer = unanswered;                  ///< main rating, or 1 / 2 for the interval chosen
  int answers = 0;                             ///< questions answered about it
  int repeats = -1;                            ///< of a repeated showing: position of its original
};

/// One catch page that was answered.
struct CatchRecord {
  std::string participant;
  int visit = 1;
  bool correct = false;
};

struct Exclusion {
  std::string participant;
  int visit = 1;
  int position = -1;   ///< of the trial; -1: the whole visit
  std::string rule;    ///< "experimenter", "interruption", "timing", "catch", "repeat", "straight_lining" or
                       ///< "incomplete"
  std::string reason;  ///< with the figures that made it so
  int answers = 0;     ///< answers that no longer count

  bool by_hand() const { return rule == "experimenter"; }
};

/// All exclusions, ordered by participant, visit and position, whole visits first. A trial or visit is listed
/// once, under the first rule that holds in the order of Exclusion::rule. `pairs`: answers are intervals
/// chosen, so that repeats are judged by agreement.
std::vector<Exclusion> find_exclusions(std::span<const TrialRecord> trials,
                                       std::span<const CatchRecord> catches, const ExclusionRules& rules,
                                       bool pairs);

/// Whether a list excludes this trial, by itself or with its visit.
bool is_excluded(std::span<const Exclusion> exclusions, const std::string& participant, int visit,
                 int position);

}  // namespace stats
