#pragma once
/// Bootstrap intervals of any statistic of one sample (Efron 1987; Davison and Hinkley 1997, chapter 5). For
/// paired data give the differences.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "stats/bootstrap.hpp"
#include "stats/result.hpp"

namespace stats {

using Statistic = std::function<double(std::span<const double>)>;

/// A bias-corrected, accelerated interval for one way of counting resamples equal to the estimate.
struct BcaInterval {
  double z0 = 0;                          ///< bias correction
  std::array<double, 2> probabilities{};  ///< quantiles of the resamples that make the interval
  std::array<double, 2> ci{};             ///< linear between order statistics (type 7)
  std::array<double, 2> ci_normal{};      ///< between order statistics on the normal scale, as R's boot.ci
};

struct BootstrapInterval {
  int n = 0, n_missing = 0;
  int resamples = 0;
  double confidence = 0.95;
  double estimate = 0;      ///< of the sample
  double mean = 0, se = 0;  ///< of the resamples (divisor N - 1)
  double acceleration = 0;  ///< from the jackknife
  BcaInterval bca{};        ///< the interval to report; ties count half, which is right for coarse statistics
  /// Only resamples strictly below the estimate count, as in R's boot. Empty when there are none, or only
  /// such.
  std::optional<BcaInterval> bca_strict{};
  std::array<double, 2> percentile{};        ///< type 7 quantiles
  std::array<double, 2> percentile_type6{};  ///< type 6 quantiles (p (N + 1))
  std::array<double, 2> basic{};             ///< 2 estimate - quantiles on the normal scale
};

/// Resamples the values (seeded; equal on every machine). The statistic must be defined for any sample of n
/// or n - 1 values drawn from x; resamples for which it is not finite make the result refused. NaN in x =
/// missing.
/// Refused: fewer than two values, so few that even their range holds the centre less often than the
/// confidence asks (1 - 2^(1 - n): below 6 values at .95), infinite values, all values equal, all resamples
/// on one side of the estimate, the same estimate in every resample or without any one value (acceleration
/// undefined). std::invalid_argument when the confidence is outside (0, 1) or there are fewer than two
/// resamples.
Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             const BootstrapOptions& options = {});

/// The same with resamples given as indices into x, one resample after the other, each of x.size() indices.
/// x must have no missing values (std::invalid_argument), nor an index outside.
Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             std::span<const int> indices, double confidence = 0.95);

/// Statistics by name: mean, median (of the two middle values), var (divisor n - 1), dz (mean / sd).
Statistic mean_statistic();
Statistic median_statistic();
Statistic variance_statistic();
Statistic dz_statistic();

}  // namespace stats
