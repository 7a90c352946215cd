#include "stats/inference/describe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "stats/inference/sample.hpp"

namespace stats {

namespace {

Result<Sample> some(std::span<const double> values) {
  auto sample = present(values);
  if (sample && sample->values.empty()) return Refusal{"no values"};
  return sample;
}

double sorted_quantile(const std::vector<Wide>& ascending, double p, QuantileType type, int exponent) {
  const auto n = static_cast<double>(ascending.size());
  // Position counted from 0.
  const double place = type == QuantileType::Linear ? p * (n - 1) : p * (n + 1) - 1;
  const double at = std::clamp(place, 0.0, n - 1);
  const auto low = static_cast<std::size_t>(at);
  const auto high = std::min(low + 1, ascending.size() - 1);
  const Wide weight = at - static_cast<double>(low);
  return std::ldexp((ascending[low] + weight * (ascending[high] - ascending[low])).value(), exponent);
}

Wide median_of(std::vector<Wide> values) {
  std::sort(values.begin(), values.end());
  const auto half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) * Wide(0.5);
}

/// Median absolute deviation from `median`, the median rounded to double, as other programs compute it. With
/// a large offset of the values this rounding shows in the result.
double median_absolute_deviation(const std::vector<Wide>& values, double median) {
  std::vector<Wide> deviations;
  for (const auto& v : values) deviations.push_back(abs(v - median));
  return median_of(std::move(deviations)).value();
}

/// Skewness, kurtosis and lag-1 autocorrelation. As ratios they do not depend on the scale.
void fill_shape(Description& out, const std::vector<Wide>& values, const Moments& m) {
  Wide third, fourth, lagged;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Wide d = values[i] - m.mean, square = d * d;
    third += square * d;
    fourth += square * square;
    if (i > 0) lagged += d * (values[i - 1] - m.mean);
  }
  const Wide n = static_cast<double>(m.n), variance = m.squares / n;
  out.skewness = (third / n / (variance * sqrt(variance))).value();
  out.kurtosis = (fourth / n / (variance * variance) - Wide(3)).value();
  out.autocorrelation = (lagged / m.squares).value();
}

}  // namespace

Result<Description> describe(std::span<const double> values) {
  const auto sample = some(values);
  if (!sample) return Refusal{sample.reason()};
  const int exponent = common_exponent(sample->values);
  auto ordered = scaled(sample->values, exponent);
  const auto m = moments(ordered);
  Description out;
  out.n = m.n;
  out.n_missing = sample->n_missing;
  out.mean = std::ldexp(m.mean.value(), exponent);
  if (m.n > 1) {
    out.sd = std::ldexp(std::sqrt(m.variance()), exponent);
    out.sem = std::ldexp(std::sqrt(m.variance() / static_cast<double>(m.n)), exponent);
    const double variance = std::ldexp(m.variance(), 2 * exponent);
    if (std::isfinite(variance) && (variance > 0 || m.variance() == 0)) out.var = variance;
  }
  if (m.squares.high > 0) fill_shape(out, ordered, m);
  std::sort(ordered.begin(), ordered.end());
  const Wide median = median_of(ordered);
  out.median = std::ldexp(median.value(), exponent);
  out.mad = std::ldexp(median_absolute_deviation(ordered, median.value()), exponent);
  out.min = std::ldexp(ordered.front().value(), exponent);
  out.max = std::ldexp(ordered.back().value(), exponent);
  out.q25 = sorted_quantile(ordered, 0.25, QuantileType::Linear, exponent);
  out.q75 = sorted_quantile(ordered, 0.75, QuantileType::Linear, exponent);
  return out;
}

Result<double> quantile(std::span<const double> values, double p, QuantileType type) {
  if (!(p >= 0 && p <= 1))
    throw std::invalid_argument("quantile: p is not within [0, 1]; give a probability");
  const auto sample = some(values);
  if (!sample) return Refusal{sample.reason()};
  const int exponent = common_exponent(sample->values);
  auto ordered = scaled(sample->values, exponent);
  std::sort(ordered.begin(), ordered.end());
  return sorted_quantile(ordered, p, type, exponent);
}

Result<BoxPlot> box_plot(std::span<const double> values) {
  const auto d = describe(values);
  if (!d) return Refusal{d.reason()};
  BoxPlot out;
  out.median = d->median;
  out.q25 = d->q25;
  out.q75 = d->q75;
  out.n = d->n;
  // A value exactly 1.5 interquartile ranges from the box is not an outlier. Means of whole answers often
  // have exactly this distance, so `rounding` allows for the rounding of quartiles and values.
  const double rounding =
      16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(d->q25), std::abs(d->q75));
  const double reach = 1.5 * (d->q75 - d->q25) + rounding;
  out.low_whisker = d->q25;
  out.high_whisker = d->q75;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    if (v < d->q25 - reach || v > d->q75 + reach) {
      ++out.n_outliers;
      continue;
    }
    out.low_whisker = std::min(out.low_whisker, v);
    out.high_whisker = std::max(out.high_whisker, v);
  }
  return out;
}

}  // namespace stats
