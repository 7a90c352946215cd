#pragma once
/// Power if effects are a factor of a protocol that shows pairs: the preference for a level over level none,
/// all else equal, by the analysis of the report's table of factors (stats/analysis/factor_levels.hpp).

#include <span>
#include <string>
#include <vector>

#include "libstudy/power/worlds.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/task2.hpp"

namespace study {

/// World "effect": every other level is chosen over none with probability PowerRequest::effect, whatever the
/// methods; or world "null". Pairs that do not contain none are chosen with .5. base::Error if the world does
/// not apply to effects, or without --effect.
World effect_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id);

/// The claim that each level is preferred over none: one t test of the participants' shares for each level,
/// with Holm over all pairs of levels.
stats::Hypothesis effect_hypothesis(std::span<const stats::PairChoice> choices, const ShownFactors& factors,
                                    const stats::AnalysisPlan& plan);

/// The true preference for the level of such a test.
double effect_truth(const Scenario& scenario, const ShownFactors& factors, const stats::HypothesisTest& test);

}  // namespace study
