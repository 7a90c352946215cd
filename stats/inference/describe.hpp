#pragma once
/// Descriptive statistics of a sample. NaN = missing: dropped and counted.

#include <cstddef>
#include <optional>
#include <span>

#include "stats/result.hpp"

namespace stats {

/// Sums are computed in double-double from scaled differences to the first value, so an offset of 1e12 or a
/// scale of 1e-150 costs no digits. A statistic that is undefined for the sample is empty.
struct Description {
  std::size_t n = 0;          ///< values used
  std::size_t n_missing = 0;  ///< values left out as NaN
  double mean = 0;
  std::optional<double> sd, var,
      sem;  ///< divisor n - 1; empty with one value; var empty beyond double's range
  double median = 0, min = 0, max = 0;
  double mad = 0;                         ///< median absolute deviation from the median, not scaled
  double q25 = 0, q75 = 0;                ///< quartiles of type 7
  std::optional<double> skewness;         ///< g1 = m3 / m2^1.5, divisor n; empty when all values are equal
  std::optional<double> kurtosis;         ///< excess, g2 = m4 / m2^2 - 3, divisor n
  std::optional<double> autocorrelation;  ///< correlation of neighbouring values (lag 1)
};

/// Describes the values. Refused: no values, an infinite value.
Result<Description> describe(std::span<const double> values);

enum class QuantileType {
  Weibull,  ///< type 6, position p (n + 1)
  Linear    ///< type 7, position 1 + p (n - 1)
};

/// p quantile, 0 <= p <= 1 (std::invalid_argument), by linear interpolation of order statistics (Hyndman and
/// Fan 1996). Refused where describe() is.
Result<double> quantile(std::span<const double> values, double p, QuantileType type = QuantileType::Linear);

/// Points of a box plot: quartiles of type 7, whiskers to the outermost values within 1.5 interquartile
/// ranges of the box (Tukey 1977), and n_outliers, the number of values beyond the whiskers.
struct BoxPlot {
  double median = 0, q25 = 0, q75 = 0, low_whisker = 0, high_whisker = 0;
  std::size_t n = 0, n_outliers = 0;
};
Result<BoxPlot> box_plot(std::span<const double> values);

}  // namespace stats
