#include "stats/analysis/ordinal_effects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "stats/inference/adjust.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

/// Answers without the missing ones, in columns.
struct Columns {
  std::vector<double> ratings, methods;
  std::vector<int> participants;
};

Columns columns_of(std::span<const MethodScore> scores) {
  Columns out;
  for (const MethodScore& score : scores) {
    if (std::isnan(score.sum)) continue;
    out.ratings.push_back(score.value());
    out.methods.push_back(score.method);
    out.participants.push_back(score.participant);
  }
  return out;
}

MethodEffect effect_of(const MixedOrdinalFit& fit, std::size_t column, int method, double confidence) {
  MethodEffect out;
  out.method = method;
  out.estimate = fit.beta[column];
  out.se = fit.se()[fit.thresholds.size() + column];
  const double half = normal_quantile(0.5 + 0.5 * confidence) * out.se;
  out.ci = {out.estimate - half, out.estimate + half};
  out.z = out.estimate / out.se;
  out.p = std::erfc(std::abs(out.z) / std::numbers::sqrt2);
  return out;
}

/// Corrects p over a family of `family` tests, which may be more than `effects`.
void correct(std::vector<MethodEffect>& effects, std::size_t family) {
  std::vector<double> p;
  for (const MethodEffect& effect : effects) p.push_back(effect.p);
  const auto holm = adjust(p, Adjustment::Holm, family);
  const auto bh = adjust(p, Adjustment::BenjaminiHochberg, family);
  for (std::size_t i = 0; holm && bh && i < effects.size(); ++i) {
    effects[i].p_holm = holm->p[i];
    effects[i].p_bh = bh->p[i];
  }
}

}  // namespace

Result<OrdinalEffects> ordinal_effects(std::span<const MethodScore> scores, int reference, int methods,
                                       double confidence) {
  const Columns columns = columns_of(scores);
  const std::set<double> present(columns.methods.begin(), columns.methods.end());
  if (!present.contains(reference)) return Refusal{"no answer about the reference method"};
  if (present.size() < 2) return Refusal{"answers about one method only"};
  const auto predictors = indicators("method", columns.methods, reference);
  const auto fit = fit_cumulative_link_mixed(columns.ratings, predictors, columns.participants, Link::Logit,
                                             15, Separation::Penalise);
  if (!fit) return Refusal{fit.reason()};
  OrdinalEffects out{*fit, reference, {}};
  std::size_t column = 0;
  for (const double method : present) {
    if (method != reference)
      out.effects.push_back(effect_of(*fit, column++, static_cast<int>(method), confidence));
  }
  correct(out.effects, static_cast<std::size_t>(methods - 1));
  const auto reduced = fit_cumulative_link_mixed(columns.ratings, {}, columns.participants);
  if (reduced) {
    out.overall =
        likelihood_ratio(fit->objective(), reduced->log_likelihood, static_cast<int>(predictors.size()));
  } else {
    out.overall = Refusal{reduced.reason()};
  }
  return out;
}

}  // namespace stats
