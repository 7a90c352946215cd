#pragma once
/// A linear mixed model of all answers of one score, reported beside the paired tests, which drop
/// participants without answers to one of the two methods. The mixed model assumes that missing answers
/// depend only on the answers given and the model's terms (missing at random); tipping.hpp treats missing
/// answers that depend on their own value.

#include <span>
#include <string>
#include <vector>

#include "stats/analysis/score_table.hpp"
#include "stats/inference/linear_mixed.hpp"
#include "stats/result.hpp"

namespace stats {

/// Period of each trial of one session, from 0 in the order of showing: a period is a run of trials of one
/// block. `blocks` holds a block number for each trial. All 0 if a block comes back after another one, that
/// is, if the order mixes blocks.
std::vector<int> periods_of(std::span<const int> blocks);

/// Fixed terms: each combination of n_* (nominal number of particles) and method, scenes and periods (each
/// against the first), and the trial's position (linear). Random effects: the participant, and the
/// participant with each method.
struct MixedScores {
  LinearMixedFit fit;

  /// Method a - method b at one n_*. Refused if a or b has no answers at this n_*.
  Result<MixedContrast> difference(int n_star, int a, int b, double confidence) const;
};

/// Fits the mixed model to all answers of the table. Refused if fit_linear_mixed() refuses.
Result<MixedScores> fit_mixed_scores(const ScoreTable& table);

}  // namespace stats
