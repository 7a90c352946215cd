#pragma once
/// Single answers of Task 1 as what they are, ordered categories: a cumulative-link model of the method with
/// a random effect of the participant, within one n_*.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/score_table.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/result.hpp"

namespace stats {

/// A method against the reference; larger = higher answers.
struct MethodEffect {
  int method = 0;
  double estimate = 0, se = 0;  ///< logits
  std::array<double, 2> ci{};   ///< Wald
  double z = 0, p = 0;
  /// Over all other methods of the study at this n_*, a method without answers as p = 1.
  std::optional<double> p_holm, p_bh;
};

struct OrdinalEffects {
  MixedOrdinalFit fit;
  int reference = 0;
  std::vector<MethodEffect> effects;  ///< of the methods that occur, without the reference
  /// Against the same model without methods, by the likelihoods that were maximised (of a penalised fit as
  /// Heinze and Schemper 2002, Stat. Med. 21, 2409-2419). Refused when that model cannot be fitted.
  Result<LikelihoodRatio> overall = Refusal{"not computed"};
};

/// Logit link, adaptive quadrature. `scores`: single answers, all of one n_*. Separated answers are fitted
/// with a penalty: fit.why_penalised names the columns as "method" + index.
/// Refused: no answer about the reference or about another method, and what fit_cumulative_link_mixed
/// refuses. `methods`: how many the study shows, one or more than those that occur. confidence in (0, 1).
Result<OrdinalEffects> ordinal_effects(std::span<const MethodScore> scores, int reference, int methods,
                                       double confidence);

}  // namespace stats
