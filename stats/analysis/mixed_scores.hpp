#pragma once
/// A linear mixed model of all answers of one score: what stands beside the paired tests, which need both of
/// a pair. Whatever is missing may depend on anything that was answered or is in the model (missing at
/// random); of what depends on the missing answers themselves tipping.hpp speaks.

#include <span>
#include <string>
#include <vector>

#include "stats/analysis/score_table.hpp"
#include "stats/inference/linear_mixed.hpp"
#include "stats/result.hpp"

namespace stats {

/// Period of each trial of one session in the order of showing, from 0: runs of trials of one block, which is
/// any number. All 0 where a block comes twice, so that the order mixes blocks.
std::vector<int> periods_of(std::span<const int> blocks);

/// Terms: each n_* with each method, scenes, the trial's position (linear) and periods against the first;
/// random effects of the participant, and of the participant with each method.
struct MixedScores {
  LinearMixedFit fit;

  /// Method a - method b at one n_*. Refused when one of them was not judged there.
  Result<MixedContrast> difference(int n_star, int a, int b, double confidence) const;
};

/// Refused as fit_linear_mixed() refuses.
Result<MixedScores> fit_mixed_scores(const ScoreTable& table);

}  // namespace stats
