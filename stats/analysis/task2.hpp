#pragma once
/// Task 2: choices between two methods, over all pairs of methods.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"
#include "stats/inference/binomial.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/inference/unanimous.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/preference/circular_triads.hpp"
#include "stats/preference/order_bias.hpp"
#include "stats/result.hpp"

namespace stats {

/// Answers of one person, n > 0, of which k chose the method in question.
struct PersonChoices {
  int k = 0, n = 0;
};

/// Name of share_test() for display.
inline constexpr const char* share_test_name = "exact permutation test of people's shares";

struct ShareTest {
  int participants = 0;
  double share = 0.5;          ///< mean of the people's shares of choices
  std::array<double, 2> ci{};  ///< Student's t of the shares, cut to [0, 1]; Clopper-Pearson over people if
                               ///< all shares are 0 or all are 1; [0, 1] without a t (equal shares, one
                               ///< person)
  std::string ci_name;         ///< name of the interval in `ci`, for display
  double p = 1;                ///< exact p of the permutation test
};

/// Test of a preference between two methods if people answered more than once: each person's share of choices
/// of one method against one half. Answers of one person need not be independent.
///
/// Computes the exact permutation test that flips the sign of each person's share minus one half. It equals
/// the exact binomial test if each person answered once. Refused: no people, and counts of answers whose
/// common denominator is too large.
Result<ShareTest> share_test(std::span<const PersonChoices> people, Alternative alternative,
                             double confidence);

/// One answered pair. Indices count from 0.
struct PairChoice {
  int participant = 0, scene = 0;
  int first = 0, second = 0;  ///< methods in the first and the second interval
  bool first_chosen = false;
  int position = 0;  ///< position of the trial in its session
};

/// All answers about two methods, a before b in the order of methods.
struct PairPreference {
  int a = 0, b = 0;
  int n = 0;             ///< answers
  int participants = 0;  ///< participants who gave these answers
  int k = 0;             ///< how often a was chosen
  int a_first = 0;       ///< how often a was shown first
  int first_chosen = 0;  ///< how often the first interval was chosen, whichever method it showed
  int max_per_participant = 0;
  int several = 0;                    ///< participants who answered this pair more than once
  std::string warning;                ///< why the test may not be valid; empty if it is
  std::vector<PersonChoices> people;  ///< one entry for each participant: choices of a, and answers
  /// Exact, two-sided. Refused without answers, and if a participant answered more than once under
  /// RepeatedPairs::Refuse or Share.
  Result<BinomialTest> test = Refusal{"not computed"};
  /// Two-sided test that replaces `test` if a participant answered more than once under RepeatedPairs::Share;
  /// empty if share_test() refuses.
  std::optional<ShareTest> shares;
  /// p corrected over all pairs; a refused test counts as not significant.
  std::optional<double> p_holm, p_bh;

  std::optional<double> p() const;  ///< p of `shares` if set, else of `test`; empty if that is refused
};

/// Bias towards choosing the first interval, whichever method it showed.
struct IntervalBias {
  int n = 0, first_chosen = 0;
  /// Test of first_chosen against n / 2; treats all answers as independent.
  Result<BinomialTest> test = Refusal{"not computed"};
  /// t test of each participant's share of choices of the first interval against one half. It is valid even
  /// if the answers of a participant are dependent.
  Result<OneSampleTTest> by_participant = Refusal{"not computed"};
  /// Set if all shares are equal, which leaves no t: the exact sign test that replaces the t test.
  std::optional<Unanimous> all_alike;
  Result<OrderBias> model = Refusal{"not computed"};  ///< the bias as a term of the Bradley-Terry model
};

struct ParticipantTriads {
  int participant = 0;
  Result<CircularTriads> triads = Refusal{"not computed"};
};

struct PreferenceAnalysis {
  std::vector<PairPreference> pairs;  ///< every pair, including those without answers
  IntervalBias interval;
  Result<BradleyTerry> bradley_terry = Refusal{"not computed"};
  std::vector<ParticipantTriads> triads;  ///< circular triads of each participant with an answer
  Result<GroupTriads> group_triads = Refusal{"not computed"};
};

/// Computes all results of Task 2. `methods`: number of methods. std::invalid_argument for a method out of
/// range or compared with itself.
PreferenceAnalysis analyse_preferences(std::span<const PairChoice> choices, int methods,
                                       const AnalysisPlan& plan);

/// Computes only the `pairs` of analyse_preferences().
std::vector<PairPreference> count_preferences(std::span<const PairChoice> choices, int methods,
                                              const AnalysisPlan& plan);

}  // namespace stats
