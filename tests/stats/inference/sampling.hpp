#pragma once
/// Random samples and the Kolmogorov-Smirnov distance, for tests of properties over many data sets.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace sampling {

inline std::vector<double> normal(std::mt19937_64& random, std::size_t n, double mean = 0, double sd = 1) {
  std::normal_distribution<double> distribution(mean, sd);
  std::vector<double> out(n);
  for (auto& v : out) v = distribution(random);
  return out;
}

/// Largest distance between the share of p-values below x and x itself, over all x.
inline double uniform_distance(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double largest = 0;
  const auto n = static_cast<double>(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double below = static_cast<double>(i) / n, above = static_cast<double>(i + 1) / n;
    largest = std::max({largest, p[i] - below, above - p[i]});
  }
  return largest;
}

/// The distance that n uniform numbers exceed with probability 0.001 (Kolmogorov's limit law; Stephens 1974).
inline double critical_distance(std::size_t n) {
  const double root = std::sqrt(static_cast<double>(n));
  return 1.9495 / (root + 0.12 + 0.11 / root);
}

}  // namespace sampling
