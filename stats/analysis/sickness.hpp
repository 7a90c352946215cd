#pragma once
/// Sickness before and after a session. The scores are skewed, with many zeros, so changes are tested by
/// signed ranks and a bootstrap, without assuming normality.

#include <span>

#include "stats/analysis/plan.hpp"
#include "stats/inference/bootstrap_interval.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/exact_mean.hpp"
#include "stats/inference/wilcoxon.hpp"
#include "stats/result.hpp"

namespace stats {

/// One score before and after the session, with one value of each per participant. Changes are after -
/// before.
struct SicknessChange {
  std::size_t n = 0;          ///< participants with both values
  std::size_t n_missing = 0;  ///< participants with only one of both values
  /// Summaries of all values, also of participants with only one of both.
  Result<Description> before = Refusal{"not computed"}, after = Refusal{"not computed"};
  Result<Description> change = Refusal{"not computed"};
  Result<BootstrapInterval> bootstrap = Refusal{"not computed"};  ///< interval of the mean change
  Result<SignedRank> ranks = Refusal{"not computed"};             ///< signed-rank test of the changes
};

/// `before` and `after` have one entry per participant: the sum and number of item answers (NaN: missing). A
/// score is `weight` times the entry's mean. All results are in units of the score; in `ranks` this holds for
/// the Hodges-Lehmann estimate and its interval alone. The ranks are computed from the entries themselves, so
/// that equal changes tie.
SicknessChange compare_sickness(std::span<const ExactMean> before, std::span<const ExactMean> after,
                                double weight, const AnalysisPlan& plan);

}  // namespace stats
