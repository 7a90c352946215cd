#pragma once
/// Exclusions by rules fixed beforehand. The rules do not read the method, scene or n_* (nominal number of
/// particles) of a trial, so they cannot depend on the differences that the study tests.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"

namespace stats {

enum class TrialTiming { Unjudged, Pass, Degraded, Fail };

/// The data of a planned trial that the rules may read.
struct TrialRecord {
  static constexpr double unanswered = std::numeric_limits<double>::quiet_NaN();

  std::string participant;
  int visit = 1;
  int position = 0;  ///< 0-based
  /// Verdict on the frame timing; for a trial that shows a pair of methods, the worse of the two intervals.
  TrialTiming timing = TrialTiming::Unjudged;
  std::string timing_reason;    ///< why the verdict is not Pass
  bool interrupted = false;     ///< excluded by the protocol's interruption policy
  std::string by_experimenter;  ///< the experimenter's reason; empty: not excluded by hand
  double answer = unanswered;   ///< main rating; for a pair, 1 or 2: the interval chosen
  int answers = 0;              ///< questions answered in this trial
  int repeats = -1;             ///< position of the original trial that this one repeats; -1: not a repeat
};

/// One answered catch page, which checks the participant's attention.
struct CatchRecord {
  std::string participant;
  int visit = 1;
  bool correct = false;
};

struct Exclusion {
  std::string participant;
  int visit = 1;
  int position = -1;   ///< position of the excluded trial; -1: the whole visit is excluded
  std::string rule;    ///< "experimenter", "interruption", "timing", "catch", "repeat", "straight_lining" or
                       ///< "incomplete"
  std::string reason;  ///< the reason in words, with the numbers that triggered the rule
  /// Number of answers excluded. For a whole visit, answers of its trials that the list excludes one by one
  /// are not counted again.
  int answers = 0;

  bool by_hand() const { return rule == "experimenter"; }
};

/// All exclusions, ordered by participant, visit and position, whole visits first. A trial or visit is listed
/// once, under the first rule that excludes it, in the order in which Exclusion::rule lists the rules.
/// `pairs`: the answers are chosen intervals, so repeats are compared by agreement.
std::vector<Exclusion> find_exclusions(std::span<const TrialRecord> trials,
                                       std::span<const CatchRecord> catches, const ExclusionRules& rules,
                                       bool pairs);

/// True if the list excludes this trial or its whole visit.
bool is_excluded(std::span<const Exclusion> exclusions, const std::string& participant, int visit,
                 int position);

}  // namespace stats
