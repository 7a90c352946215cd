#include "libstudy/pacing/frame_order.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "libstudy/base/random.hpp"

namespace study {

namespace {

/// n samples of the standard normal distribution (Box and Muller 1958).
std::vector<double> gaussian(std::size_t n, RandomStream& random) {
  std::vector<double> out(n);
  for (double& value : out) {
    const double radius = std::sqrt(-2 * std::log(random.uniform()));
    value = radius * std::cos(2 * std::numbers::pi * random.uniform());
  }
  return out;
}

/// Orders `sorted` (ascending) so that its ranks equal the ranks of `pattern`. Among equal entries of
/// `pattern`, the one with the smaller entry of `tie` ranks lower.
std::vector<double> by_ranks(const std::vector<double>& sorted, const std::vector<double>& pattern,
                             const std::vector<std::uint64_t>& tie) {
  std::vector<std::size_t> place(pattern.size());
  std::iota(place.begin(), place.end(), 0);
  std::sort(place.begin(), place.end(), [&](std::size_t a, std::size_t b) {
    return pattern[a] != pattern[b] ? pattern[a] < pattern[b] : tie[a] < tie[b];
  });
  std::vector<double> out(sorted.size());
  for (std::size_t rank = 0; rank < place.size(); ++rank) out[place[rank]] = sorted[rank];
  return out;
}

std::vector<double> ar1_pattern(const std::vector<double>& noise, double coefficient) {
  std::vector<double> out(noise.size());
  const double gain = std::sqrt(1 - coefficient * coefficient);
  for (std::size_t i = 0; i < noise.size(); ++i)
    out[i] = i ? coefficient * out[i - 1] + gain * noise[i] : noise[i];
  return out;
}

std::vector<double> ar1_order(const std::vector<double>& sorted, double wished, RandomStream& random) {
  const auto noise = gaussian(sorted.size(), random);
  std::vector<std::uint64_t> tie(sorted.size());
  for (auto& value : tie) value = random.bits();
  const auto at = [&](double coefficient) { return by_ranks(sorted, ar1_pattern(noise, coefficient), tie); };
  // Bisects the coefficient and keeps the order whose correlation is nearest to `wished`. The correlation
  // rises with the coefficient, except for small jumps where two ranks swap.
  double low = -0.9999, high = 0.9999;
  auto best = at(wished);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    auto tried = at(middle);
    const double got = lag1(tried);
    (got < wished ? low : high) = middle;
    if (std::abs(got - wished) < std::abs(lag1(best) - wished)) best = std::move(tried);
  }
  return best;
}

std::vector<double> trace_order(const std::vector<double>& sorted, const std::vector<double>& trace,
                                RandomStream& random) {
  std::vector<double> pattern(sorted.size());
  std::vector<std::uint64_t> tie(sorted.size());
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    pattern[i] = trace[i % trace.size()];
    tie[i] = random.bits();
  }
  return by_ranks(sorted, pattern, tie);
}

}  // namespace

double lag1(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (values[i] - mean) * (values[i] - mean);
    if (i) products += (values[i] - mean) * (values[i - 1] - mean);
  }
  // If all values are equal, the sum of squares contains only rounding errors.
  const bool equal = squares <= 1e-24 * mean * mean * static_cast<double>(values.size());
  return equal ? 0 : products / squares;
}

std::vector<double> ordered(std::vector<double> values, const PacingRules& rules, std::uint64_t seed) {
  RandomStream random(seed);
  std::sort(values.begin(), values.end());
  switch (rules.order) {
    case FrameOrder::White:
      shuffle(values, random);
      return values;
    case FrameOrder::Ar1:
      return ar1_order(values, rules.ar1, random);
    case FrameOrder::Trace:
      return rules.trace_rates.empty() ? values : trace_order(values, rules.trace_rates, random);
  }
  return values;
}

}  // namespace study
