#pragma once
/// The analysis plan, fixed before the data are seen: margins, alpha, exclusion rules, seed. Preregistration
/// stores it in a bundle.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stats/analysis/declared_test.hpp"
#include "stats/inference/adjust.hpp"
#include "stats/ptpe/pilot_people.hpp"

namespace stats {

/// Which trials to exclude by their timing verdict (for a pair, the worse of two): none, those that failed,
/// or also the degraded ones. Degraded trials are included by default, because their realised timing is known
/// and close to the requested one.
enum class TimingRule { None, Fail, Degraded };

/// How to test a pair that a participant answered more than once. The binomial test assumes independent
/// answers; several answers of one person are dependent, and the test then rejects too often.
enum class RepeatedPairs {
  Refuse,
  Warn,   ///< run the binomial test with a warning
  Share,  ///< test the people's shares of choices (share_test() of task2.hpp)
  First   ///< use only each person's first answer
};

struct ExclusionRules {
  TimingRule timing = TimingRule::Fail;
  /// Smallest share of catch pages answered correctly, in [0, 1]; empty: no such rule. Applies only to visits
  /// with answered catch pages.
  std::optional<double> min_catch_correct = 0.5;
  /// Largest mean |difference| between a repeated showing and its original, points of the main rating; empty:
  /// no such rule. On seven points random answers differ by 2.3 on average, so 3 excludes only visits whose
  /// repeats differ more than random answers do.
  std::optional<double> max_repeat_difference = 3.0;
  /// Smallest share of repeated pairs answered alike, in [0, 1]. Empty by default: there is no such rule,
  /// since a person who answers one or two repeated pairs cannot be judged by them.
  std::optional<double> min_repeat_agreement;
  /// Excludes a visit with the same answer to every trial (main rating or chosen interval), if it has at
  /// least this many answers; 0: no such rule. Off by default: a person who sees no difference also gives
  /// equal answers, and without such people differences look larger than they are.
  int straight_lining_answers = 0;
  /// Smallest share of a visit's planned trials that must be answered, in [0, 1].
  double min_answered = 0;
};

/// How the tests of a hypothesis decide its verdict.
enum class DecisionRule {
  /// The claim needs all of its tests, each at alpha, uncorrected; the claim's error is then at most alpha
  /// (Berger 1982). The weaker verdict PartlySupported needs at least one test that holds after Holm.
  IntersectionUnion,
  Holm,  ///< each test must hold after Holm; preregistrations made before the key `decision` existed use this
         ///< rule
};

/// The kind of tests of scores in Task 1 (ratings).
enum class ScoreTests {
  Paired,  ///< paired t tests of participants' means
  Mixed,   ///< t tests of the mixed model of all answers (mixed_scores.hpp)
};

/// Which hypotheses are tested one-sided.
enum class Directional {
  None,  ///< two-sided: the interval of 1 - alpha must lie wholly in the claimed range
  All,   ///< one-sided: the interval of 1 - 2 alpha must lie in the claimed range
  Once,  ///< one-sided where once_one_sided is set; preregistrations made before the key `directional`
         ///< existed use this rule
};

enum class HypothesisKind { Superiority, Equivalence, NonInferiority, Preference };
/// The kind in words: "superiority", "equivalence", "non-inferiority", "preference".
const char* kind_name(HypothesisKind kind);

/// When the paper's procedure counts a test as confirmed, by its uncorrected two-sided p.
enum class PaperHolds {
  Significant,     ///< p < alpha, in the direction claimed
  NotSignificant,  ///< p >= alpha
  NotWorse,        ///< p >= alpha, or in the direction of better
};

/// A hypothesis about methods, as declared in a plan file. Its tests are one family.
struct MethodClaim {
  /// The procedure by which a paper tested the hypothesis.
  struct Paper {
    std::string rule;  ///< the procedure in words
    PaperHolds holds = PaperHolds::Significant;
    std::string published;  ///< the paper's verdict on its own data
  };

  std::string id;    ///< a name without spaces
  std::string text;  ///< the hypothesis in words
  int task = 1;      ///< 1: ratings; 2: choices between two methods
  HypothesisKind kind = HypothesisKind::Superiority;
  std::vector<std::string> scores;  ///< Task 1: "realism", "sickness"
  std::vector<std::string> a, b;    ///< methods; each of `a` is compared with each of `b`
  /// Task 1: margin by score, in points. A score without an entry has the plan's margin.
  std::map<std::string, double> margins = {};
  bool needs_gaze = false;       ///< not testable unless gaze was tracked
  bool once_one_sided = false;   ///< tested one-sided under Directional::Once
  bool larger_families = false;  ///< Task 2: p is also given after Holm over larger families of pairs
  std::string called = {};       ///< Task 2: words for the methods `a` in the printed rule; empty: their
                                 ///< names
  std::optional<Paper> paper = {};
};

/// A hypothesis of a study with factors of its own, as declared in a plan file.
struct DeclaredHypothesis {
  /// Level by factor. Factors that are not named are averaged within each participant.
  using Levels = std::map<std::string, std::string>;

  std::string id;
  std::string text = {};        ///< the hypothesis in words; may be empty
  std::string outcome;          ///< id of a question, or threshold_outcome
  std::vector<Levels> compare;  ///< a and b; one entry: a is compared with `against`
  std::optional<double> against = {};
  /// Questions with labelled choices: the score whose share of the answers is the outcome. Empty: the higher
  /// one if there are two choices. Must be empty if the outcome is not a share.
  std::optional<int> positive = {};
  DeclaredTest test = {};
  std::string family = {};  ///< hypotheses of one family are adjusted together; empty: not adjusted
  Adjustment adjust = Adjustment::None;
};
/// The outcome of an adaptive procedure: each participant's threshold.
inline constexpr const char* threshold_outcome = "threshold";

/// A comparison of models of frame timing, as declared in a plan file.
struct DeclaredComparison {
  std::string question;             ///< id of the question whose answers the models predict
  std::vector<std::string> models;  ///< two or more, by the names of vip-stats compare-models
  int folds = 0;                    ///< groups of people that are left out in turn; 0: each person
  std::string expected = {};        ///< the model that is expected to predict best; empty: none
};

struct AnalysisPlan {
  double alpha = 0.05;  ///< level of the tests of each claim, in (0, 0.5)
  DecisionRule decision = DecisionRule::IntersectionUnion;
  Directional directional = Directional::None;
  ScoreTests tests = ScoreTests::Paired;
  double confidence = 0.95;       ///< confidence of intervals, in (0, 1)
  double margin_realism = 0.5;    ///< points of the scale from 1 to 7, > 0
  double margin_sickness = 0.25;  ///< points of the scale from 0 to 3, > 0
  ExclusionRules exclusions;
  RepeatedPairs repeated_pairs = RepeatedPairs::Share;
  int resamples = 10000;  ///< number of bootstrap resamples
  std::uint64_t seed = 1;
  /// By question id: the mean score at which a pilot's curve of just satisfactory frame rates is fitted. The
  /// protocol sets it for questions that are not listed.
  std::map<std::string, double> levels = {};
  PilotRules pilot = {};  ///< how to treat reverse coders, drift and lapses in a pilot
  std::vector<DeclaredHypothesis> hypotheses = {};  ///< hypotheses of studies with factors
  std::vector<MethodClaim> claims = {};             ///< about methods; empty: those of
                                                    ///< protocols/plans/paper.toml
  std::optional<DeclaredComparison> comparison = {};
};

}  // namespace stats
