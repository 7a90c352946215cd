#pragma once
/// Sickness before and after a session. Its scores are skewed, with many zeros: changes go by signed ranks
/// and by a bootstrap, without an assumption of normality.

#include <span>

#include "stats/analysis/plan.hpp"
#include "stats/inference/bootstrap_interval.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/exact_mean.hpp"
#include "stats/inference/wilcoxon.hpp"
#include "stats/result.hpp"

namespace stats {

/// A score before and after, one value for each participant; differences are after - before.
struct SicknessChange {
  std::size_t n = 0;          ///< participants with both
  std::size_t n_missing = 0;  ///< participants with one of them alone
  Result<Description> before = Refusal{"not computed"}, after = Refusal{"not computed"};  ///< all there are
  Result<Description> change = Refusal{"not computed"};
  Result<BootstrapInterval> bootstrap = Refusal{"not computed"};  ///< of the mean change
  Result<SignedRank> ranks = Refusal{"not computed"};             ///< of the changes
};

/// `before` and `after` are sums of items, participant by participant (NaN: missing); a score is `weight`
/// times their mean, and so is all that is returned but the ranks, which compare the sums themselves, so that
/// equal changes tie. Only the ranks' location and its interval are scores again.
/// std::invalid_argument unless the lengths agree and counts are above 0.
SicknessChange compare_sickness(std::span<const ExactMean> before, std::span<const ExactMean> after,
                                double weight, const AnalysisPlan& plan);

}  // namespace stats
