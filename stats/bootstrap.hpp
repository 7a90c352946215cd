#pragma once
/// Resampling of participants: draws that are the same on every machine, and intervals from them.

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
  /// called after each resample with the number done; may be empty
  std::function<void(int)> progress = {};
};

/// Weights of one bootstrap resample: how often each of n units is drawn in one resample of n with
/// replacement. A pure function of (n, seed, resample): the generator is counter-based, and no distribution
/// of the standard library is used.
std::vector<double> resample_weights(int n, std::uint64_t seed, std::uint64_t resample);

/// Tail probability of the expanded percentile interval: Phi(-sqrt(n / (n-1)) t(n-1)). n >= 2.
double expanded_tail(int n, double confidence);

/// Expanded percentile interval (Hesterberg 2015, section 5.3): quantiles of the resampled estimates at
/// expanded_tail, which corrects the percentile interval's narrowness for few units. std::invalid_argument
/// when `estimates` is empty or n < 2.
std::array<double, 2> expanded_percentile_interval(std::span<const double> estimates, int n,
                                                   double confidence);

/// Standard deviation of resampled estimates (divisor N - 1). Needs at least two.
double bootstrap_se(std::span<const double> estimates);

}  // namespace stats
