#pragma once
/// Bootstrap intervals of any statistic of one sample (Efron 1987; Davison and Hinkley 1997, chapter 5). For
/// paired data pass the differences.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "stats/bootstrap.hpp"
#include "stats/result.hpp"

namespace stats {

using Statistic = std::function<double(std::span<const double>)>;

/// A bias-corrected, accelerated (BCa) interval, for one way of counting resamples equal to the estimate.
struct BcaInterval {
  double z0 = 0;                          ///< bias correction
  std::array<double, 2> probabilities{};  ///< probabilities of the resamples' quantiles that bound the
                                          ///< interval
  std::array<double, 2> ci{};             ///< interpolated linearly between order statistics (type 7)
  std::array<double, 2> ci_normal{};      ///< interpolated on the normal scale, as in R's boot.ci
};

struct BootstrapInterval {
  int n = 0, n_missing = 0;
  int resamples = 0;
  double confidence = 0.95;
  double estimate = 0;      ///< the statistic of the sample
  double mean = 0, se = 0;  ///< mean and sd of the resampled estimates (divisor N - 1)
  double acceleration = 0;  ///< acceleration of the BCa interval, from the jackknife
  BcaInterval bca{};  ///< the interval to report: a resample equal to the estimate counts half as below and
                      ///< half as above the estimate
  /// Counts only resamples strictly below the estimate, as R's boot does. Empty if no or all resamples are
  /// below the estimate, or if the acceleration reverses the tails.
  std::optional<BcaInterval> bca_strict{};
  std::array<double, 2> percentile{};        ///< type 7 quantiles
  std::array<double, 2> percentile_type6{};  ///< type 6 quantiles (p (N + 1))
  std::array<double, 2> basic{};             ///< ends 2 estimate - q, for quantiles q interpolated on the
                                             ///< normal scale
};

/// Resamples the values (seeded; the same on every machine). The statistic must be defined for any sample of
/// n or n - 1 values drawn from x; the result is refused if it is not finite for a resample. NaN in x =
/// missing. Refused: fewer than two values; so few that even their range covers the centre less often than
/// the confidence (1 - 2^(1 - n): below 6 values at .95); infinite values; all values equal; all resamples on
/// one side of the estimate; the same estimate whichever one value is left out, or one that is not finite
/// (acceleration undefined); an acceleration so large that it reverses the tails. std::invalid_argument if
/// the confidence is outside (0, 1) or resamples < 2.
Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             const BootstrapOptions& options = {});

/// The same interval from given resamples. `indices` are indices into x, one resample after the other, each
/// of x.size() indices. std::invalid_argument also if x has missing values, an index is out of range or the
/// indices do not fill at least two whole resamples.
Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             std::span<const int> indices, double confidence = 0.95);

/// The mean; the median (the mean of the two middle values if their number is even); the variance, with
/// divisor n - 1; and dz, the mean over the standard deviation.
Statistic mean_statistic();
Statistic median_statistic();
Statistic variance_statistic();
Statistic dz_statistic();

}  // namespace stats
