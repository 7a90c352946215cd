#pragma once
/// Power where effects are a factor of a protocol that shows pairs: what a level is worth over level none,
/// all else alike, by the analysis of the report's table of factors (stats/analysis/factor_levels.hpp).

#include <span>
#include <string>
#include <vector>

#include "apps/stats/power/worlds.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/task2.hpp"

namespace apps {

/// "effect": every other level is chosen over none with PowerRequest::effect, whatever the methods; "null".
/// What is not parted by none is chosen with .5. base::Error: a world that knows no effects, no --effect.
World effect_world(const PowerRequest& request, const ShownFactors& factors, const std::string& id);

/// The claim that each level is preferred over none: one test a level, t of the participants' shares, Holm
/// over all pairs of levels.
stats::Hypothesis effect_hypothesis(std::span<const stats::PairChoice> choices, const ShownFactors& factors,
                                    const stats::AnalysisPlan& plan);

/// Of such a test: the true preference for its level.
double effect_truth(const Scenario& scenario, const ShownFactors& factors, const stats::HypothesisTest& test);

}  // namespace apps
