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

/// A score before and after, one value each per participant; differences are after - before.
struct SicknessChange {
  std::size_t n = 0;          ///< participants with both
  std::size_t n_missing = 0;  ///< participants with only one of them
  Result<Description> before = Refusal{"not computed"}, after = Refusal{"not computed"};  ///< of all values
  Result<Description> change = Refusal{"not computed"};
  Result<BootstrapInterval> bootstrap = Refusal{"not computed"};  ///< of the mean change
  Result<SignedRank> ranks = Refusal{"not computed"};             ///< of the changes
};

/// `before` and `after` are sums of items with one entry per participant (NaN: missing). A score is `weight`
/// times the entry's mean, and all results are in units of the score, except the ranks: these compare the
/// sums themselves, so that equal changes tie. Of `ranks`, only the location and its interval are in units of
/// the score.
SicknessChange compare_sickness(std::span<const ExactMean> before, std::span<const ExactMean> after,
                                double weight, const AnalysisPlan& plan);

}  // namespace stats
