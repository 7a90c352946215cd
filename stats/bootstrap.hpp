#pragma once
/// Resampling of participants: draws that are equal on every machine, and the interval made of them.

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
  /// Told how many resamples are done, after each; may be empty.
  std::function<void(int)> progress = {};
};

/// How often each of n units is drawn in one resample of n with replacement. A pure function of (n, seed,
/// resample): counter-based, no library distribution.
std::vector<double> resample_weights(int n, std::uint64_t seed, std::uint64_t resample);

/// Tail probability of the expanded percentile interval: Phi(-sqrt(n / (n-1)) t(n-1)). n >= 2.
double expanded_tail(int n, double confidence);

/// Expanded percentile interval (Hesterberg 2015, section 5.3): quantiles of the resampled estimates at
/// expanded_tail, which makes up for the percentile interval's narrowness with few units.
/// std::invalid_argument when `estimates` is empty or n < 2.
std::array<double, 2> expanded_percentile_interval(std::span<const double> estimates, int n,
                                                   double confidence);

/// Standard deviation of resampled estimates (divisor N - 1); at least two.
double bootstrap_se(std::span<const double> estimates);

}  // namespace stats
