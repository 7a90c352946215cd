#pragma once
/// Midranks, and exact distributions of sums of ranks. The rank tests in this folder use them.

#include <cstddef>
#include <span>
#include <vector>

namespace stats {

struct Midranks {
  std::vector<double> ranks;  ///< rank of each value, 1 for the smallest; tied values share their mean rank
  double tie_sum = 0;         ///< sum of t^3 - t over all groups of t tied values
  bool has_ties() const { return tie_sum > 0; }
};

/// `values` must not contain NaN. Equal values share their rank. Means and their differences that are
/// mathematically equal may differ as doubles unless exact_mean.hpp computes them.
Midranks midranks(std::span<const double> values);

/// P(S <= s) and P(S >= s) for a sum S of midranks.
struct RankSumTails {
  double lower = 0, upper = 0;
};

/// Tails of S, a sum that includes each rank with probability 1/2: the null distribution of the signed-rank
/// test, given the ranks. `sum` is s.
RankSumTails signed_rank_tails(std::span<const double> ranks, double sum);

}  // namespace stats
