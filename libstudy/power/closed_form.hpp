#pragma once
/// The power of one uncorrected test, if there is a formula.

#include <optional>

#include "libstudy/power/request.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// Power of a test with this true difference (or preference for `a`) at n participants: p < alpha in the
/// direction claimed. For Task 1 as if answers were continuous. Empty for the mixed model and for levels of
/// effects, which have no formula.
std::optional<double> closed_form_power(const PowerRequest& request, const stats::Hypothesis& hypothesis,
                                        const stats::HypothesisTest& test, double truth, int n);

/// True if the test's claim is true.
bool claim_is_true(stats::HypothesisKind kind, const stats::HypothesisTest& test, double truth);

/// True if a higher score is better.
bool higher_is_better(const stats::HypothesisTest& test);

}  // namespace study
