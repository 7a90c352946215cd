#pragma once
/// p-values corrected for multiple tests within a family.

#include <cstddef>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// Bonferroni and Holm bound the probability of any false rejection in the family; Benjamini and Hochberg
/// bound the expected share of false rejections among the rejections.
enum class Adjustment {
  None,
  Bonferroni,
  Holm,               ///< Holm 1979; valid under any dependence
  BenjaminiHochberg,  ///< Benjamini and Hochberg 1995
};

struct AdjustedP {
  std::vector<double> p;   ///< corrected p-values in the order given; NaN where the input was missing
  std::size_t family = 0;  ///< number of tests corrected for
  std::size_t missing = 0;
};

/// Corrects p-values by `method`. Missing values (NaN) stay missing and are not counted as tests. `family` is
/// the number of tests; 0 means the number of p-values that are not missing. If `family` is larger than that
/// number, the absent p-values count as 1. Refused: no p-value at all, one outside [0, 1], a family smaller
/// than the number given.
Result<AdjustedP> adjust(std::span<const double> p, Adjustment method, std::size_t family = 0);

/// Marks of significance as in the ViP-Fluid paper (Fig. 9 and 10): "***" for p < .001, "**" for p < .01, "*"
/// for p < .05, else "".
const char* stars(double p);

}  // namespace stats
