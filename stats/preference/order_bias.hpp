#pragma once
/// Order effects on choices: Bradley-Terry with terms for the interval and the position in the session
/// (Davidson and Beaver 1977).

#include <array>
#include <optional>
#include <span>

#include "stats/preference/logit_fit.hpp"
#include "stats/result.hpp"

namespace stats {

/// One term in the logit of choosing the first interval.
struct OrderTerm {
  double estimate = 0;  ///< logits
  double se = 0;  ///< standard error with each person's answers as one cluster, if people_errors() gives it;
                  ///< else se_independent
  double se_independent = 0;   ///< standard error that treats answers as independent
  std::optional<double> df;    ///< degrees of freedom of Student's t for `ci` and `p_wald`; empty: normal
  std::array<double, 2> ci{};  ///< Wald interval
  double p_wald = 0;
  double lrt_chi2 = 0;  ///< likelihood ratio against the model without this term, 1 df; treats answers as
                        ///< independent
  double lrt_p = 0;
};

struct OrderBias {
  int items = 0;
  int n = 0, first_chosen = 0;
  double confidence = 0.95;
  OrderTerm interval;  ///< constant bias towards the first interval: the logit of choosing item i, shown
                       ///< before j, is lambda_i - lambda_j + interval with the items' strengths lambda
  double first_probability = 0.5;  ///< probability of choosing the first of two equal items
  std::array<double, 2> first_probability_ci{};
  /// Change of the interval's bias per unit of position; positions are centred at their mean. Empty if
  /// fit_logit() refuses the model with this term, as when all positions are equal.
  std::optional<OrderTerm> drift{};
};

/// Estimates the order effects. Trials of one participant are correlated: standard errors and Wald tests take
/// each person's answers as one cluster if people_errors() allows it; likelihood ratios treat all trials as
/// independent. Refused: no trial, fewer than two items, items never compared, orders of showing that do not
/// determine the bias towards an interval, separation (the reason says of which model). std::invalid_argument
/// for an item outside [0, items), equal items, a position that is not finite, or a confidence outside (0,
/// 1).
Result<OrderBias> order_bias(std::span<const Comparison> trials, int items, double confidence = 0.95);

}  // namespace stats
