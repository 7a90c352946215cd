#include "stats/preference/next_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "stats/preference/quality_scale.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

/// Entropy of an answer that falls on one side with this probability, bits.
double entropy(double p) {
  const double q = 1 - p;
  return (p > 0 ? -p * std::log2(p) : 0) - (q > 0 ? q * std::log2(q) : 0);
}

/// Mutual information, in bits, of one answer and a difference that is normal with this mean and variance.
/// The trapezoidal rule over 8 standard deviations converges exponentially.
double information(double mean, double variance) {
  constexpr int steps = 160;
  constexpr double reach = 8;
  double expected = 0, weights = 0;
  for (int s = 0; s <= steps; ++s) {
    const double z = reach * (2.0 * s / steps - 1), weight = std::exp(-z * z / 2);
    expected += weight * entropy(normal_probability((mean + z * std::sqrt(variance)) / jod_sigma));
    weights += weight;
  }
  const double before = normal_probability(mean / std::sqrt(jod_sigma * jod_sigma + variance));
  return std::max(0.0, entropy(before) - expected / weights);
}

/// Fisher's information of one answer about the difference, at this difference.
double fisher(double difference) {
  const double z = difference / jod_sigma;
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi) / jod_sigma;
  const double p = normal_probability(z), q = normal_probability(-z);
  return p > 0 && q > 0 ? density * density / (p * q) : 0;
}

}  // namespace

std::vector<NextPair> next_pairs(std::span<const double> jod, std::span<const double> covariance, int count) {
  const std::size_t n = jod.size();
  if (n < 2 || covariance.size() != n * n || count < 0)
    throw std::invalid_argument(
        "next_pairs: the covariance does not fit the scale, or the count is negative; give at least two "
        "conditions, n x n covariances and a count of 0 or more");
  std::vector<double> now(covariance.begin(), covariance.end());
  const auto variance = [&](std::size_t i, std::size_t j) {
    return std::max(0.0, now[i * n + i] + now[j * n + j] - 2 * now[i * n + j]);
  };
  std::vector<NextPair> out;
  for (int k = 0; k < count; ++k) {
    NextPair best{.bits = -1};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) {
        const double bits = information(jod[i] - jod[j], variance(i, j));
        // Differences by rounding do not decide between equal pairs.
        if (bits <= best.bits * (1 + 1e-9)) continue;
        const double spread = std::sqrt(jod_sigma * jod_sigma + variance(i, j));
        best = {static_cast<int>(i), static_cast<int>(j), bits,
                normal_probability((jod[i] - jod[j]) / spread)};
      }
    }
    out.push_back(best);
    const auto i = static_cast<std::size_t>(best.first), j = static_cast<std::size_t>(best.second);
    const double known = fisher(jod[i] - jod[j]), factor = known / (1 + known * variance(i, j));
    std::vector<double> with(n);  // covariance of each condition with the difference
    for (std::size_t a = 0; a < n; ++a) with[a] = now[a * n + i] - now[a * n + j];
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) now[a * n + b] -= factor * with[a] * with[b];
  }
  return out;
}

}  // namespace stats
