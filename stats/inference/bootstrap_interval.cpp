#include "stats/inference/bootstrap_interval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Values = std::vector<double>;
using Interval = std::array<double, 2>;

void require_confidence(double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        "bootstrap_interval: the confidence is not between 0 and 1; give one such as 0.95");
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Sum over the values of (mean - value)^power.
double moment(std::span<const double> values, int power) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double v : values) sum += std::pow(mean - v, power);
  return sum;
}

double variance_of(std::span<const double> values) {
  return moment(values, 2) / (static_cast<double>(values.size()) - 1);
}

/// Type 6 of Hyndman and Fan 1996: the order statistic at position p (N + 1), clamped to the first and the
/// last.
double quantile_type6(std::span<const double> ascending, double p) {
  const double at =
      std::clamp(p * (static_cast<double>(ascending.size()) + 1), 1.0, static_cast<double>(ascending.size()));
  const auto low = static_cast<std::size_t>(at);
  const auto high = std::min(low + 1, ascending.size());
  return std::lerp(ascending[low - 1], ascending[high - 1], at - static_cast<double>(low));
}

/// The order statistic at position p (N + 1), interpolated on the scale of normal quantiles (Davison and
/// Hinkley 1997, Eq. 5.8).
double quantile_normal(std::span<const double> ascending, double p) {
  const double spaces = static_cast<double>(ascending.size()) + 1, at = p * spaces;
  if (at <= 1) return ascending.front();
  if (at >= spaces - 1) return ascending.back();
  const double low = std::floor(at);
  const double before = normal_quantile(low / spaces), after = normal_quantile((low + 1) / spaces);
  const auto index = static_cast<std::size_t>(low);
  return std::lerp(ascending[index - 1], ascending[index], (normal_quantile(p) - before) / (after - before));
}

/// The sample without missing values, its estimate, and the jackknife's acceleration.
struct Resampled {
  Values x;
  int n_missing = 0;
  double estimate = 0, acceleration = 0;
};

/// Why the sample is too small; empty if it is not. No interval from resamples exceeds the range of the n
/// values. This range covers the centre of a symmetric distribution with probability 1 - 2^(1 - n).
std::string too_few(std::size_t n, double confidence) {
  const double most = 1 - std::exp2(1 - static_cast<double>(n));
  if (most >= confidence) return {};
  return fmt::format(
      "{} values are too few: an interval within their range holds at most {:.4g} %, not {:.4g} %", n,
      100 * most, 100 * confidence);
}

Result<Resampled> prepare(std::span<const double> x, const Statistic& statistic, double confidence) {
  Resampled out;
  for (const double v : x) {
    if (std::isinf(v)) return Refusal{"an infinite value"};
    if (std::isnan(v))
      ++out.n_missing;
    else
      out.x.push_back(v);
  }
  const std::size_t n = out.x.size();
  if (n < 2) return Refusal{"fewer than two values"};
  if (const std::string reason = too_few(n, confidence); !reason.empty()) return Refusal{reason};
  if (std::all_of(out.x.begin(), out.x.end(), [&](double v) { return v == out.x.front(); }))
    return Refusal{"all values are equal: bias and acceleration are undefined"};

  out.estimate = statistic(out.x);
  Values without_one;
  for (std::size_t i = 0; i < n; ++i) {
    Values rest = out.x;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    without_one.push_back(statistic(rest));
  }
  const double squares = moment(without_one, 2), cubes = moment(without_one, 3);
  if (!std::isfinite(out.estimate) || !std::isfinite(squares))
    return Refusal{"the statistic is undefined for the sample or without one of its values"};
  if (!(squares > 0)) return Refusal{"no value makes a difference to the statistic: acceleration undefined"};
  out.acceleration = cubes / (6 * squares * std::sqrt(squares));
  return out;
}

/// Returns nothing if all resampled estimates lie on one side of the sample's estimate, or if the
/// acceleration is so large that it reverses the order of the tails.
std::optional<BcaInterval> bca_interval(std::span<const double> ascending, double share_below,
                                        double acceleration, double confidence) {
  if (!(share_below > 0 && share_below < 1)) return std::nullopt;
  BcaInterval out;
  out.z0 = normal_quantile(share_below);
  for (std::size_t end = 0; end < 2; ++end) {
    const double z = normal_quantile(0.5 + (end == 0 ? -0.5 : 0.5) * confidence);
    const double stretch = 1 - acceleration * (out.z0 + z);
    if (!(stretch > 0)) return std::nullopt;
    const double p = normal_probability(out.z0 + (out.z0 + z) / stretch);
    out.probabilities[end] = p;
    out.ci[end] = sorted_quantile(ascending, p);
    out.ci_normal[end] = quantile_normal(ascending, p);
  }
  return out;
}

Result<BootstrapInterval> summarise(const Resampled& sample, Values estimates, double confidence) {
  if (!std::all_of(estimates.begin(), estimates.end(), [](double v) { return std::isfinite(v); }))
    return Refusal{"the statistic is undefined for a resample"};
  BootstrapInterval out{.n = static_cast<int>(sample.x.size()),
                        .n_missing = sample.n_missing,
                        .resamples = static_cast<int>(estimates.size()),
                        .confidence = confidence,
                        .estimate = sample.estimate,
                        .mean = mean_of(estimates),
                        .se = bootstrap_se(estimates),
                        .acceleration = sample.acceleration};
  std::sort(estimates.begin(), estimates.end());
  const auto total = static_cast<double>(estimates.size());
  // Resamples add the same values in another order. `rounding` makes estimates that differ from the sample's
  // estimate by rounding alone count as equal to it.
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * std::abs(sample.estimate);
  const auto first = std::lower_bound(estimates.begin(), estimates.end(), sample.estimate - rounding);
  const auto last = std::upper_bound(first, estimates.end(), sample.estimate + rounding);
  const auto below = static_cast<double>(first - estimates.begin());
  const auto equal = static_cast<double>(last - first);

  const auto bca = bca_interval(estimates, (below + equal / 2) / total, sample.acceleration, confidence);
  if (!bca) return Refusal{"all resamples lie on one side of the estimate: its bias is not determined"};
  out.bca = *bca;
  out.bca_strict = bca_interval(estimates, below / total, sample.acceleration, confidence);

  for (std::size_t end = 0; end < 2; ++end) {
    const double p = 0.5 + (end == 0 ? -0.5 : 0.5) * confidence;
    out.percentile[end] = sorted_quantile(estimates, p);
    out.percentile_type6[end] = quantile_type6(estimates, p);
    out.basic[1 - end] = 2 * sample.estimate - quantile_normal(estimates, p);
  }
  return out;
}

}  // namespace

Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             const BootstrapOptions& options) {
  require_confidence(options.confidence);
  if (options.resamples < 2)
    throw std::invalid_argument(
        "bootstrap_interval: fewer than two resamples; set BootstrapOptions::resamples to 2 or more");
  const auto sample = prepare(x, statistic, options.confidence);
  if (!sample) return Refusal{sample.reason()};
  const auto n = static_cast<int>(sample->x.size());
  Values estimates, drawn;
  for (int resample = 0; resample < options.resamples; ++resample) {
    const auto weights = resample_weights(n, options.seed, static_cast<std::uint64_t>(resample));
    drawn.clear();
    for (std::size_t i = 0; i < weights.size(); ++i)
      drawn.insert(drawn.end(), static_cast<std::size_t>(weights[i]), sample->x[i]);
    estimates.push_back(statistic(drawn));
    if (options.progress) options.progress(resample + 1);
  }
  return summarise(*sample, std::move(estimates), options.confidence);
}

Result<BootstrapInterval> bootstrap_interval(std::span<const double> x, const Statistic& statistic,
                                             std::span<const int> indices, double confidence) {
  require_confidence(confidence);
  const auto sample = prepare(x, statistic, confidence);
  if (!sample) return Refusal{sample.reason()};
  if (sample->n_missing > 0)
    throw std::invalid_argument(
        "bootstrap_interval: x has missing values (NaN) although indices are given; remove these values "
        "first");
  const std::size_t n = x.size();
  if (indices.size() < 2 * n || indices.size() % n != 0)
    throw std::invalid_argument(
        "bootstrap_interval: the indices do not fill two or more whole resamples; give x.size() indices for "
        "each");
  Values estimates, drawn(n);
  for (std::size_t first = 0; first < indices.size(); first += n) {
    for (std::size_t i = 0; i < n; ++i) {
      const int index = indices[first + i];
      if (index < 0 || static_cast<std::size_t>(index) >= n)
        throw std::invalid_argument(
            "bootstrap_interval: an index lies outside x; give indices from 0 to x.size() - 1");
      drawn[i] = x[static_cast<std::size_t>(index)];
    }
    estimates.push_back(statistic(drawn));
  }
  return summarise(*sample, std::move(estimates), confidence);
}

Statistic mean_statistic() { return mean_of; }

Statistic median_statistic() {
  return [](std::span<const double> values) {
    Values sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted_quantile(sorted, 0.5);
  };
}

Statistic variance_statistic() { return variance_of; }

Statistic dz_statistic() {
  return [](std::span<const double> values) { return mean_of(values) / std::sqrt(variance_of(values)); };
}

}  // namespace stats
