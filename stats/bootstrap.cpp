#include "stats/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/quantiles.hpp"

namespace stats {

namespace {
/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
}  // namespace

std::vector<double> resample_weights(int n, std::uint64_t seed, std::uint64_t resample) {
  std::vector<double> weights(static_cast<std::size_t>(n), 0.0);
  std::uint64_t state = mix(mix(seed + golden) + golden * (resample + 1));
  for (int draw = 0; draw < n; ++draw) {
    state += golden;
    // Scales the high 32 bits of a random number to an index in [0, n). Each index's probability differs from
    // 1/n by less than 2^-32.
    weights[static_cast<std::size_t>((mix(state) >> 32) * static_cast<std::uint64_t>(n) >> 32)] += 1;
  }
  return weights;
}

double expanded_tail(int n, double confidence) {
  if (n < 2) throw std::invalid_argument("expanded_tail: fewer than two units; resample at least two");
  const double t = student_quantile(0.5 + confidence / 2, n - 1);
  return normal_probability(-std::sqrt(n / (n - 1.0)) * t);
}

std::array<double, 2> expanded_percentile_interval(std::span<const double> estimates, int n,
                                                   double confidence) {
  std::vector<double> sorted(estimates.begin(), estimates.end());
  std::sort(sorted.begin(), sorted.end());
  const double tail = expanded_tail(n, confidence);
  return {sorted_quantile(sorted, tail), sorted_quantile(sorted, 1 - tail)};
}

double bootstrap_se(std::span<const double> estimates) {
  if (estimates.size() < 2)
    throw std::invalid_argument("bootstrap_se: fewer than two estimates; compute at least two resamples");
  const double n = static_cast<double>(estimates.size());
  double mean = 0, squares = 0;
  for (const double x : estimates) mean += x / n;
  for (const double x : estimates) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / (n - 1));
}

}  // namespace stats
