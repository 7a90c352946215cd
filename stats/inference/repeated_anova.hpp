#pragma once
/// One-way analysis of variance with repeated measures.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

struct RepeatedAnova {
  int n = 0;          ///< participants used
  int n_missing = 0;  ///< participants dropped because they lack a value
  int k = 0;          ///< conditions
  double ss_conditions = 0, ss_subjects = 0, ss_error = 0;
  double f = 0;
  double df1 = 0, df2 = 0;  ///< degrees of freedom before any correction
  double p = 0;             ///< valid if the differences between conditions have equal variances (sphericity)
  double epsilon_gg = 0;    ///< Greenhouse and Geisser 1959, 1 / (k-1) to 1; 1 means sphericity
  /// Huynh and Feldt 1976, not capped: may exceed 1. Empty if its denominator is 0, as always for n = 2.
  std::optional<double> epsilon_hf{};
  /// The value used to correct degrees of freedom: at most 1, since 1 already means sphericity.
  std::optional<double> epsilon_hf_capped() const {
    return epsilon_hf ? std::optional(std::min(1.0, *epsilon_hf)) : std::nullopt;
  }
  double p_gg = 0;               ///< p with df1 and df2 multiplied by epsilon_gg
  std::optional<double> p_hf{};  ///< p with df1 and df2 multiplied by epsilon_hf_capped()
  double partial_eta2 = 0;       ///< ss_conditions / (ss_conditions + ss_error)
  double generalized_eta2 = 0;   ///< ss_conditions / total (Olejnik and Algina 2003)
  std::vector<double> means{};   ///< mean of each condition
};

/// Tests if the means of k conditions differ. `rows`: participants by conditions, row after row, each of k
/// values; NaN = missing. Refused: fewer than two conditions or complete participants, infinite values, no
/// variation within participants beyond the conditions' means (F would divide by zero), sums of squares
/// beyond the range of double. std::invalid_argument when the values do not fill whole rows or k < 1.
Result<RepeatedAnova> repeated_anova(std::span<const double> rows, int k);

}  // namespace stats
