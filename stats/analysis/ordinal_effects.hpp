#pragma once
/// The single answers of Task 1 (ratings) as ordered categories: a cumulative-link model of the method with a
/// random effect of the participant, within one n_* (nominal number of particles).

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/score_table.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/result.hpp"

namespace stats {

/// Effect of a method relative to the reference method; above 0: higher answers.
struct MethodEffect {
  int method = 0;
  double estimate = 0, se = 0;  ///< log odds ratio, method against reference
  std::array<double, 2> ci{};   ///< Wald interval
  double z = 0, p = 0;
  /// Corrected over all methods of the study but the reference, at this n_* (nominal number of particles); a
  /// method without answers counts as p = 1.
  std::optional<double> p_holm, p_bh;
};

struct OrdinalEffects {
  MixedOrdinalFit fit;
  int reference = 0;
  std::vector<MethodEffect> effects;  ///< one effect for each method with answers except the reference
  /// Likelihood-ratio test against the same model without methods, from the maximised objectives; a penalised
  /// fit is compared by its penalised likelihood (Heinze and Schemper 2002, Stat. Med. 21, 2409-2419).
  /// Refused if that model cannot be fitted.
  Result<LikelihoodRatio> overall = Refusal{"not computed"};
};

/// Fits the model with the logit link and adaptive quadrature. `scores`: single answers, all of one n_*
/// (nominal number of particles). Separated answers are fitted with a penalty: fit.why_penalised names the
/// columns as "method" + index. Refused: no answer about the reference or about another method, and all
/// refusals of fit_cumulative_link_mixed. `methods`: number of methods in the study, including any without
/// answers. confidence in (0, 1).
Result<OrdinalEffects> ordinal_effects(std::span<const MethodScore> scores, int reference, int methods,
                                       double confidence);

}  // namespace stats
