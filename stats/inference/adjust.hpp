#pragma once
/// p-values corrected for their number within a family.

#include <cstddef>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// Bonferroni and Holm bound the chance of one or more false rejections in the family, Benjamini and Hochberg
/// the expected share of false ones among the rejections.
enum class Adjustment {
  None,
  Bonferroni,
  Holm,               ///< Holm 1979; valid under any dependence
  BenjaminiHochberg,  ///< Benjamini and Hochberg 1995
};

struct AdjustedP {
  std::vector<double> p;   ///< in the order given; NaN exactly where the input was missing
  std::size_t family = 0;  ///< size of the family that was corrected for
  std::size_t missing = 0;
};

/// Missing values (NaN) stay missing and do not count. `family` is the number of tests when it is larger than
/// the number of p-values given; the others are taken as not significant (p = 1). 0: as many as are given.
/// Refused: no p-value at all, one outside [0, 1], a family smaller than the number given.
Result<AdjustedP> adjust(std::span<const double> p, Adjustment method, std::size_t family = 0);

/// The paper's marks (Fig. 9 and 10): "***" for p < .001, "**" for p < .01, "*" for p < .05, else "".
const char* stars(double p);

}  // namespace stats
