#include "libstudy/power/closed_form.hpp"

#include <cmath>

#include "stats/inference/power.hpp"

namespace study {

namespace {

using stats::Alternative;
using stats::HypothesisKind;

/// Tolerance for truths, which are sums of decimal fractions.
constexpr double rounding = 1e-9;

std::optional<double> value_of(const stats::Result<double>& result) {
  return result ? std::optional(*result) : std::nullopt;
}

}  // namespace

bool higher_is_better(const stats::HypothesisTest& test) { return test.score == "realism"; }

bool claim_is_true(HypothesisKind kind, const stats::HypothesisTest& test, double truth) {
  const double better = higher_is_better(test) ? truth : -truth;
  switch (kind) {
    case HypothesisKind::Superiority:
      return better > rounding;
    case HypothesisKind::Equivalence:
      return std::abs(truth) < test.margin.value_or(0) - rounding;
    case HypothesisKind::NonInferiority:
      return better > -test.margin.value_or(0) + rounding;
    case HypothesisKind::Preference:
      break;
  }
  return truth > 0.5 + rounding;
}

std::optional<double> closed_form_power(const PowerRequest& request, const stats::Hypothesis& hypothesis,
                                        const stats::HypothesisTest& test, double truth, int n) {
  const bool by_model = request.plan.plan.tests == stats::ScoreTests::Mixed;
  if (by_model && hypothesis.kind != HypothesisKind::Preference) return {};
  // The claimed side of a symmetric two-sided test is the one-sided test at half the level.
  const double level = (hypothesis.one_sided ? 1 : 0.5) * hypothesis.alpha, margin = test.margin.value_or(0);
  const double sd = higher_is_better(test) ? request.sd_realism : request.sd_sickness;
  const double better = higher_is_better(test) ? truth : -truth;
  switch (hypothesis.kind) {
    case HypothesisKind::Superiority:
      return value_of(stats::t_power(n, better / sd, level, stats::Design::Paired, Alternative::Greater));
    case HypothesisKind::Equivalence:
      return value_of(stats::tost_power(n, {-margin, margin, sd, truth, level}));
    case HypothesisKind::NonInferiority:
      return value_of(
          stats::t_power(n, (better + margin) / sd, level, stats::Design::Paired, Alternative::Greater));
    case HypothesisKind::Preference:
      break;
  }
  const bool of_shares = !request.protocol.design.effects.empty();  // by t, not exactly
  if (request.interval_bias != 0 || of_shares) return {};
  const auto power = stats::binomial_power(n, truth, 0.5, level, Alternative::Greater);
  return power ? std::optional(power->power) : std::nullopt;
}

}  // namespace study
