#pragma once
/// Test of uniform p-values (Kolmogorov-Smirnov), with draws that do not depend on the standard library.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace uniformity {

/// SplitMix64: the same numbers on every machine.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : state_(seed) {}
  /// In (0, 1).
  double uniform() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (static_cast<double>((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
  }
  double normal() { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform()); }
  bool coin(double p = 0.5) { return uniform() < p; }

 private:
  std::uint64_t state_;
};

/// sqrt(n) times the largest distance between the distribution of n values and the uniform one. If the values
/// are uniform, it exceeds 1.95 with probability .001.
inline double distance(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto rank = static_cast<double>(i);
    largest = std::max({largest, values[i] - rank / n, (rank + 1) / n - values[i]});
  }
  return largest * std::sqrt(n);
}

constexpr double critical = 1.95;

}  // namespace uniformity
