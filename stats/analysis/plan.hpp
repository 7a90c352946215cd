#pragma once
/// What is fixed before the data are seen: margins, level, exclusion rules, seed. Preregistration freezes it.

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "stats/ptpe/pilot_people.hpp"

namespace stats {

/// Trials left out by timing verdict, the worse of two for a pair. Degraded trials stay by default: what was
/// really shown is known and lies near what was wished.
enum class TimingRule { None, Fail, Degraded };

/// A participant with several answers to one pair breaks the binomial test's independence (pooled blocks: 9.6
/// % false alarms at 5 %).
enum class RepeatedPairs {
  Refuse,
  Warn,   ///< the binomial test all the same
  Share,  ///< each person's share is tested over people (share_test.hpp)
  First   ///< the first answer of each person counts alone
};

struct ExclusionRules {
  TimingRule timing = TimingRule::Fail;
  /// Least share of catch pages answered as attention would, in [0, 1]; none: not asked for. Concerns those
  /// who saw catch pages.
  std::optional<double> min_catch_correct = 0.5;
  /// Largest mean |difference| between a repeated showing and its original, points of the main rating; none:
  /// no such rule. On seven points random answers differ by 2.3 on average, so 3 leaves out those who do
  /// worse.
  std::optional<double> max_repeat_difference = 3.0;
  /// Least share of repeated pairs answered alike, in [0, 1]; none by default, since one repeat tells
  /// nothing.
  std::optional<double> min_repeat_agreement;
  /// One and the same answer to every trial of a visit (main rating, or interval chosen), given this many
  /// answers or more; 0: no such rule. None by default: who honestly sees no difference answers alike too,
  /// and without them differences look larger than they are.
  int straight_lining_answers = 0;
  /// Least share of a visit's planned trials that must be answered, in [0, 1].
  double min_answered = 0;
};

/// From the tests of a hypothesis to its verdict.
enum class DecisionRule {
  /// The claim needs all of its tests: each at alpha, uncorrected, which errs at most at alpha (Berger 1982).
  /// "At least one" is claimed after Holm.
  IntersectionUnion,
  Holm,  ///< every test after Holm, as bundles were frozen before the key was there
};

/// What the tests of H1 to H3 are made of.
enum class ScoreTests {
  Paired,  ///< paired t tests of participants' means
  Mixed,   ///< t tests of the mixed model of all answers (mixed_scores.hpp)
};

/// Which hypotheses are tested one-sided. All claim a direction.
enum class Directional {
  None,    ///< two-sided: the interval of 1 - alpha lies wholly where it is claimed to
  All,     ///< one-sided: that of 1 - 2 alpha does
  H2H3H6,  ///< as bundles were frozen before the key was there
};

struct AnalysisPlan {
  double alpha = 0.05;  ///< of each claim, in (0, 0.5)
  DecisionRule decision = DecisionRule::IntersectionUnion;
  Directional directional = Directional::None;
  ScoreTests tests = ScoreTests::Paired;
  double confidence = 0.95;       ///< of intervals, in (0, 1)
  double margin_realism = 0.5;    ///< points on 1 to 7, > 0
  double margin_sickness = 0.25;  ///< points on 0 to 3, > 0
  ExclusionRules exclusions;
  RepeatedPairs repeated_pairs = RepeatedPairs::Share;
  int resamples = 10000;  ///< of BCa intervals
  std::uint64_t seed = 1;
  /// Scores at which a pilot's curve is fitted, by id of the question; of others the protocol says it.
  std::map<std::string, double> levels = {};
  PilotRules pilot = {};  ///< reverse coders, drift and lapses of a pilot
};

}  // namespace stats
