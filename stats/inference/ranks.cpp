#include "stats/inference/ranks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace stats {

namespace {

/// Twice each midrank, which is a whole number.
std::vector<std::size_t> doubled(std::span<const double> ranks) {
  std::vector<std::size_t> out;
  for (const double r : ranks) out.push_back(static_cast<std::size_t>(std::lround(2 * r)));
  return out;
}

RankSumTails tails(std::span<const double> weights, double sum) {
  const auto at = static_cast<std::size_t>(std::lround(2 * sum));
  RankSumTails out;
  double total = 0;
  // Adds rare sums first, from both ends, so that small tails are accurate.
  for (std::size_t s = 0; s < weights.size(); ++s) {
    if (s <= at) out.lower += weights[s];
  }
  for (std::size_t s = weights.size(); s-- > at;) out.upper += weights[s];
  total = out.lower + out.upper - weights[at];
  return {std::min(out.lower / total, 1.0), std::min(out.upper / total, 1.0)};
}

}  // namespace

Midranks midranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
  Midranks out;
  out.ranks.resize(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    const auto size = static_cast<double>(end - first);
    out.tie_sum += size * (size * size - 1);
    for (std::size_t i = first; i < end; ++i) out.ranks[order[i]] = static_cast<double>(first + 1 + end) / 2;
    first = end;
  }
  return out;
}

RankSumTails signed_rank_tails(std::span<const double> ranks, double sum) {
  const auto steps = doubled(ranks);
  const auto largest = std::accumulate(steps.begin(), steps.end(), std::size_t{0});
  std::vector<double> weights(largest + 1, 0.0);
  weights[0] = 1;
  std::size_t reached = 0;
  for (const auto step : steps) {
    reached += step;
    // Halving at each step makes the weights probabilities, which do not overflow for any n.
    for (std::size_t s = reached + 1; s-- > 0;) {
      weights[s] = (weights[s] + (s >= step ? weights[s - step] : 0)) / 2;
    }
  }
  return tails(weights, sum);
}

}  // namespace stats
