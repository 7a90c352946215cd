#pragma once
/// The exact test of a proportion, with intervals and effect sizes, for the 2AFC answers of Task 2 (choices
/// between two methods).

#include <array>

#include "stats/inference/distributions.hpp"
#include "stats/result.hpp"

namespace stats {

/// k successes in n independent trials. One-sided alternatives have one-sided intervals: [0, upper] for Less,
/// [lower, 1] for Greater.
struct BinomialTest {
  double k = 0, n = 0;  ///< whole numbers
  double p0 = 0.5;      ///< proportion under the null
  Alternative alternative = Alternative::TwoSided;
  double confidence = 0.95;
  double estimate = 0;  ///< k / n
  /// Exact. Two-sided: the sum of all point probabilities that do not exceed the observed one (by more than
  /// 1e-7 of it), as in R's binom.test; not the doubled tail. A p below the range of double is given as the
  /// smallest positive double, since it is not zero.
  double p = 0;
  /// Mid-p: only half of the observed point's probability counts; two-sided it is twice the smaller tail
  /// (Lancaster 1961; Berry and Armitage 1995).
  double p_mid = 0;
  std::array<double, 2> clopper_pearson{};  ///< exact interval (Clopper and Pearson 1934)
  std::array<double, 2> wilson{};           ///< score interval (Wilson 1927)
  std::array<double, 2> wilson_cc{};  ///< score interval with continuity correction (Newcombe 1998, method 4)
  /// Quantiles of Beta(k + 1/2, n - k + 1/2). At k = 0 the lower end is 0, at k = n the upper end is 1.
  std::array<double, 2> jeffreys{};
  std::array<double, 2> agresti_coull{};  ///< Agresti and Coull 1998; may leave [0, 1]
  double cohen_g = 0;                     ///< estimate - p0
  double cohen_h = 0;                     ///< 2 asin sqrt(estimate) - 2 asin sqrt(p0)
};

/// Tests k successes in n trials against the proportion p0. Refused: n < 1, k outside [0, n], counts that are
/// not whole numbers or above 1e9, p0 outside [0, 1]. std::invalid_argument when the confidence is outside
/// (0, 1).
Result<BinomialTest> binomial_test(double k, double n, double p0 = 0.5,
                                   Alternative alternative = Alternative::TwoSided, double confidence = 0.95);

/// The p-value of binomial_test(). std::invalid_argument if binomial_test refuses.
double binomial_p(double k, double n, double p0 = 0.5, Alternative alternative = Alternative::TwoSided);

}  // namespace stats
