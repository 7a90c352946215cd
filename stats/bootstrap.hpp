#pragma once
/// Bootstrap over participants: random draws that are the same on every machine, and confidence intervals
/// from the resampled estimates.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace stats {

struct BootstrapOptions {
  int resamples = 2000;
  std::uint64_t seed = 1;
  double confidence = 0.95;  ///< in (0, 1)
  /// Called after each resample with the number of resamples done so far; not called if empty.
  std::function<void(int)> progress = {};
};

/// Weights of one bootstrap resample: how often each of n units is drawn in one resample of n with
/// replacement. A pure function of (n, seed, resample): the generator is counter-based, and no distribution
/// of the standard library is used.
std::vector<double> resample_weights(int n, std::uint64_t seed, std::uint64_t resample);

/// Tail probability of the expanded percentile interval: Phi(-sqrt(n / (n-1)) t), where t is Student's
/// quantile at (1 + confidence) / 2 with n - 1 degrees of freedom. n is the number of units, at least 2
/// (std::invalid_argument otherwise).
double expanded_tail(int n, double confidence);

/// Expanded percentile interval (Hesterberg 2015, section 5.3): the quantiles of `estimates` at probabilities
/// p and 1 - p, p = expanded_tail(n, confidence). n is the number of resampled units. With few units the
/// plain percentile interval is too narrow; the smaller p widens it. std::invalid_argument when `estimates`
/// is empty or n < 2.
std::array<double, 2> expanded_percentile_interval(std::span<const double> estimates, int n,
                                                   double confidence);

/// Standard error: the standard deviation of N resampled estimates, with divisor N - 1. std::invalid_argument
/// if N < 2.
double bootstrap_se(std::span<const double> estimates);

}  // namespace stats
