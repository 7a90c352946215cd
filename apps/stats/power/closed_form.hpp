#pragma once
/// The power of one uncorrected test, where there is a formula.

#include <optional>

#include "apps/stats/power/request.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace apps {

/// Of a test with this true difference (or preference for `a`) at n participants: p < alpha in the direction
/// claimed. Task 1 as if answers were continuous; the mixed model and levels of effects have no formula.
std::optional<double> closed_form_power(const PowerRequest& request, const stats::Hypothesis& hypothesis,
                                        const stats::HypothesisTest& test, double truth, int n);

/// Whether what a test claims is true.
bool claim_is_true(stats::HypothesisKind kind, const stats::HypothesisTest& test, double truth);

/// Whether a higher score is better.
bool higher_is_better(const stats::HypothesisTest& test);

}  // namespace apps
