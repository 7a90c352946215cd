#pragma once
/// Power of the study's tests, and the smallest effects they detect. Exact: no simulation and no normal
/// approximation.

#include <optional>

#include "stats/inference/distributions.hpp"
#include "stats/result.hpp"

namespace stats {

/// Paired equals OneSample on the differences; TwoSample has n in each of two independent groups.
enum class Design { OneSample, Paired, TwoSample };

/// Power of Student's t-test for a standardised difference d (mean over the SD of the differences, or of a
/// group): computed by the noncentral t; a two-sided test counts the rejections in both tails. A
/// non-inferiority or superiority test against a margin has this power with d = (difference - margin) / sd
/// and a one-sided alternative. n (per group) may be a fraction. Refused: n <= 1 or above 1e7, alpha outside
/// (0, 1), d not finite.
Result<double> t_power(double n, double d, double alpha = 0.05, Design design = Design::Paired,
                       Alternative alternative = Alternative::TwoSided);

/// The smallest d > 0 that the t-test detects with this power; for Alternative::Less the effect is -d.
/// Refused: as t_power, or a power outside (alpha, 1).
Result<double> t_detectable(double n, double power, double alpha = 0.05, Design design = Design::Paired,
                            Alternative alternative = Alternative::TwoSided);

/// An equivalence test (two one-sided t-tests) in the units of the scale.
struct Equivalence {
  double low = -0.5, high = 0.5;  ///< margins
  double sd = 1;                  ///< standard deviation of the differences, or of each group
  double difference = 0;          ///< true difference
  double alpha = 0.05;            ///< level of each one-sided test
  Design design = Design::Paired;
};

/// Probability that both one-sided tests reject, exact (integral over the sample's variance: Owen 1965,
/// Phillips 1990). Refused: n <= 1 or above 1e7, sd <= 0, low >= high, alpha outside (0, 0.5], a value that
/// is not finite.
Result<double> tost_power(double n, const Equivalence& equivalence);

/// Power and critical counts of the exact test of a proportion.
struct BinomialPower {
  double power = 0;         ///< probability of a significant result if the true proportion is p1
  double actual_alpha = 0;  ///< the same probability if the true proportion is p0; at most alpha
  /// Smallest k above n p0 and largest k below it that are significant; empty where none is.
  std::optional<int> k_critical_upper{}, k_critical_lower{};
};

/// The exact binomial test's power, from critical counts found by bisection. Refused: n < 1, above 1e9 or not
/// whole, p0 or p1 outside [0, 1], alpha outside (0, 1).
Result<BinomialPower> binomial_power(double n, double p1, double p0 = 0.5, double alpha = 0.05,
                                     Alternative alternative = Alternative::TwoSided);

/// The smallest true proportion, at least one half, for which the exact two-sided test against one half has
/// this power. Refused: n < 1, a power or alpha outside (0, 1), n too small for any result to be significant.
Result<double> binomial_detectable(int n, double power, double alpha = 0.05);

}  // namespace stats
