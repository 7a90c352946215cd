#pragma once
/// Power for a protocol that shows pairs and has effects as a factor. Each test compares one level of effects
/// with level none, in pairs that differ in nothing else: is the level preferred? The report's table of
/// factors has the same test (stats/analysis/factor_levels.hpp).

#include <span>
#include <string>
#include <vector>

#include "libstudy/power/worlds.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/task2.hpp"

namespace study {

/// Makes world "effect" or "null". In "effect" each level is chosen over none with probability
/// PowerRequest::effect, for all methods. In all other pairs, and in all pairs of "null", each of the two is
/// chosen with probability .5. base::Error for another world, for a protocol without level none, or for
/// "effect" without --effect.
World effect_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id);

/// Tests the claim that each level is preferred over none: one t test of the participants' shares for each
/// level, corrected by Holm's method over all pairs of levels.
stats::Hypothesis effect_hypothesis(std::span<const stats::PairChoice> choices, const ShownFactors& factors,
                                    const stats::AnalysisPlan& plan);

/// The true preference for the level that a test of effect_hypothesis() compares with none.
double effect_truth(const Scenario& scenario, const ShownFactors& factors, const stats::HypothesisTest& test);

}  // namespace study
