#pragma once
/// Task 2: which of two methods was chosen, over all pairs of methods.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"
#include "stats/analysis/share_test.hpp"
#include "stats/inference/binomial.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/inference/unanimous.hpp"
#include "stats/preference/bradley_terry.hpp"
#include "stats/preference/circular_triads.hpp"
#include "stats/preference/order_bias.hpp"
#include "stats/result.hpp"

namespace stats {

/// One answered pair. Indices count from 0.
struct PairChoice {
  int participant = 0, scene = 0;
  int first = 0, second = 0;  ///< methods in the first and the second interval
  bool first_chosen = false;
  int position = 0;  ///< of the trial in its session
};

/// All answers about two methods, a before b in the order of methods.
struct PairPreference {
  int a = 0, b = 0;
  int n = 0;             ///< answers
  int participants = 0;  ///< who gave them
  int k = 0;             ///< a chosen
  int a_first = 0;       ///< a shown first
  int first_chosen = 0;  ///< the first interval chosen, whichever method it held
  int max_per_participant = 0;
  int several = 0;                    ///< participants who answered it more than once
  std::string warning;                ///< empty, or why the test does not hold as it stands
  std::vector<PersonChoices> people;  ///< of each participant: a chosen, answers
  /// Exact, two-sided. Refused without answers, and with several of one participant under
  /// RepeatedPairs::Refuse and Share.
  Result<BinomialTest> test = Refusal{"not computed"};
  /// In its place, two-sided: where a participant gave several answers, under RepeatedPairs::Share.
  std::optional<ShareTest> shares;
  std::optional<double> p_holm, p_bh;  ///< over all pairs; a refused test counts as not significant

  std::optional<double> p() const;  ///< of the test that decides
};

/// Whether the first interval drew choices, whatever it held.
struct IntervalBias {
  int n = 0, first_chosen = 0;
  Result<BinomialTest> test = Refusal{"not computed"};  ///< as if all answers were independent
  /// Share of each participant against one half: holds whatever a participant's answers have in common.
  Result<OneSampleTTest> by_participant = Refusal{"not computed"};
  std::optional<Unanimous> all_alike;  ///< every participant has the same share: tested in place of t
  Result<OrderBias> model = Refusal{"not computed"};  ///< within the Bradley-Terry model
};

struct ParticipantTriads {
  int participant = 0;
  Result<CircularTriads> triads = Refusal{"not computed"};
};

struct PreferenceAnalysis {
  std::vector<PairPreference> pairs;  ///< every pair, also those without answers
  IntervalBias interval;
  Result<BradleyTerry> bradley_terry = Refusal{"not computed"};
  std::vector<ParticipantTriads> triads;  ///< those who answered anything
  Result<GroupTriads> group_triads = Refusal{"not computed"};
};

/// `methods`: how many. std::invalid_argument for a method out of range or shown against itself.
PreferenceAnalysis analyse_preferences(std::span<const PairChoice> choices, int methods,
                                       const AnalysisPlan& plan);

/// Its pairs alone.
std::vector<PairPreference> count_preferences(std::span<const PairChoice> choices, int methods,
                                              const AnalysisPlan& plan);

}  // namespace stats
