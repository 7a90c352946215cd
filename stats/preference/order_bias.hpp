#pragma once
/// Does the interval or the place in the session sway the choice? Bradley-Terry with order terms (Davidson
/// and Beaver 1977).

#include <array>
#include <optional>
#include <span>

#include "stats/result.hpp"

namespace stats {

/// One 2AFC trial.
struct Comparison {
  int first = 0, second = 0;  ///< items shown in the first and the second interval, from 0
  bool first_chosen = false;
  double position = 0;  ///< place of the trial in its session, 1, 2, 3 ...; any unit
};

/// One term in the logit of choosing the first interval.
struct OrderTerm {
  double estimate = 0;  ///< logits
  double se = 0;
  std::array<double, 2> ci{};  ///< Wald
  double p_wald = 0;
  double lrt_chi2 = 0;  ///< likelihood ratio against the model without this term, 1 df
  double lrt_p = 0;
};

struct OrderBias {
  int items = 0;
  int n = 0, first_chosen = 0;
  double confidence = 0.95;
  OrderTerm interval;  ///< constant pull of the first interval: logit = lambda_i - lambda_j + interval
  double first_probability = 0.5;  ///< of the first interval between equal items
  std::array<double, 2> first_probability_ci{};
  /// Change of that pull with position, per unit, about the mean position; empty when all positions are
  /// equal or the fit is separated with it.
  std::optional<OrderTerm> drift{};
};

/// Trials of one participant are correlated; the tests treat them as independent and are approximate then.
/// Refused: no trial, fewer than two items, items never compared, orders that leave
/// the interval's pull undetermined, separation
/// (the reason says of what). std::invalid_argument for an item outside [0, items), equal items, a position
/// that is not finite, or a confidence outside (0, 1).
Result<OrderBias> order_bias(std::span<const Comparison> trials, int items, double confidence = 0.95);

}  // namespace stats
