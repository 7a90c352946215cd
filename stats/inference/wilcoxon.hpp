#pragma once
/// Wilcoxon's signed-rank test. NaN = missing: dropped and counted. More than 7,070 differences, which have
/// more than 2.5e7 pairs, are refused.

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "stats/inference/exact_mean.hpp"
#include "stats/result.hpp"

namespace stats {

/// Exact p-values are conditional on the observed midranks, so they are valid with ties; without ties they
/// equal the classical p-values. They are omitted beyond 1000 differences, where the normal p-values suffice;
/// only Pratt's version counts zeros among these.
struct SignedRank {
  std::size_t n = 0, n_nonzero = 0, n_missing = 0;
  double w_plus = 0, w_minus = 0;  ///< sums of midranks of |d|, zeros dropped (Wilcoxon 1945)
  bool has_ties = false;           ///< among the |d| that are not zero
  double rank_biserial = 0;        ///< (w_plus - w_minus) / (w_plus + w_minus)
  std::optional<double> p_exact, p_exact_less, p_exact_greater;  ///< p_exact is twice the smaller one-sided
                                                                 ///< p, at most 1
  double p_normal = 0;              ///< two-sided, tie-corrected, with continuity correction
  double p_normal_uncorrected = 0;  ///< as p_normal, but without continuity correction
  /// The p to report: exact if there is one, else normal.
  double p() const { return p_exact.value_or(p_normal); }
  /// Pratt's (1959) version: zeros are ranked with the other differences, and the ranks of the zeros are then
  /// dropped. pratt_p_normal has no continuity correction.
  double pratt_w_plus = 0, pratt_z = 0, pratt_p_normal = 0;
  std::optional<double> pratt_p_exact;
  double hodges_lehmann = 0;  ///< median of all Walsh averages (d_i + d_j) / 2, i <= j, zeros included
  /// Order statistics of the Walsh averages, chosen by the exact distribution, both ends included. The level
  /// is at least the confidence; if n is too small for that, the interval is the range of all Walsh averages.
  /// Empty beyond n = 1000.
  std::optional<std::array<double, 2>> hodges_lehmann_ci;
  /// The probability that hodges_lehmann_ci covers the centre: at least the confidence, or 1 - 2^(1 - n) if n
  /// is too small for the confidence (below 6 at .95). Exact without ties and zeros; with them the coverage
  /// is at least this probability (Noether 1967, J. Am. Stat. Assoc. 62, 184-188). 0 without an interval.
  double hodges_lehmann_level = 0;
};

/// Tests differences against a median of zero. Two differences tie only if they are equal doubles.
/// std::invalid_argument unless confidence lies in (0, 1). Refused: no values, an infinite value, no nonzero
/// difference.
Result<SignedRank> signed_rank(std::span<const double> differences, double confidence = 0.95);
/// The same test for exact differences of means. Equal differences tie, whatever the counts of the means.
Result<SignedRank> signed_rank(const ExactDifferences& differences, double confidence = 0.95);

}  // namespace stats
