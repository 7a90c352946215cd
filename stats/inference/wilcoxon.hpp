#pragma once
/// Wilcoxon's signed-rank test. NaN = missing: dropped and counted. More than 2.5e7 pairs of values (7,070
/// differences) are refused.

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "stats/inference/exact_mean.hpp"
#include "stats/result.hpp"

namespace stats {

/// Exact p-values condition on the midranks found, so they hold with ties as well; without ties they are the
/// classical ones. They are left out beyond n = 1000, where the normal ones serve.
struct SignedRank {
  std::size_t n = 0, n_nonzero = 0, n_missing = 0;
  double w_plus = 0, w_minus = 0;  ///< sums of midranks of |d|, zeros dropped (Wilcoxon 1945)
  bool has_ties = false;           ///< among the |d| that are not zero
  double rank_biserial = 0;        ///< (w_plus - w_minus) / (w_plus + w_minus)
  std::optional<double> p_exact, p_exact_less, p_exact_greater;  ///< two-sided: twice the smaller, at most 1
  double p_normal = 0;              ///< two-sided, tie-corrected, with continuity correction
  double p_normal_uncorrected = 0;  ///< without continuity correction
  /// The p that is reported: exact where there is one, else normal.
  double p() const { return p_exact.value_or(p_normal); }
  /// Zeros ranked with the others, their ranks then dropped (Pratt 1959).
  double pratt_w_plus = 0, pratt_z = 0, pratt_p_normal = 0;
  std::optional<double> pratt_p_exact;
  double hodges_lehmann = 0;  ///< median of all Walsh averages (d_i + d_j) / 2, i <= j, zeros included
  /// Order statistics of the Walsh averages by the exact distribution, both ends included, at least the
  /// confidence asked for, or all of them when n is too small for it; empty beyond n = 1000.
  std::optional<std::array<double, 2>> hodges_lehmann_ci;
  /// The share of samples in which that interval holds the centre: above the confidence asked for, or
  /// 1 - 2^(1 - n) where n is too small for it (below 6 at .95). Exact without ties and zeros; with them the
  /// interval holds the centre at least as often (Noether 1967, J. Am. Stat. Assoc. 62, 184-188).
  double hodges_lehmann_level = 0;
};

/// Differences as the doubles they are, against a median of zero. std::invalid_argument unless confidence
/// lies in (0, 1). Refused: no values, an infinite value, no difference that is not zero.
Result<SignedRank> signed_rank(std::span<const double> differences, double confidence = 0.95);
/// Differences of means: equal ones are ties, whatever the counts.
Result<SignedRank> signed_rank(const ExactDifferences& differences, double confidence = 0.95);

}  // namespace stats
