#pragma once
/// Midranks, and exact distributions of sums of ranks. For the rank tests in this folder.

#include <cstddef>
#include <span>
#include <vector>

namespace stats {

struct Midranks {
  std::vector<double> ranks;  ///< in the order of the values, from 1; tied values share their mean rank
  double tie_sum = 0;         ///< sum over ties of (t^3 - t)
  bool has_ties() const { return tie_sum > 0; }
};

/// `values` must not contain NaN. Equal values share their rank. Equal means and differences are equal
/// doubles only if they come from exact_mean.hpp.
Midranks midranks(std::span<const double> values);

/// P(S <= s) and P(S >= s) for a sum S of midranks.
struct RankSumTails {
  double lower = 0, upper = 0;
};

/// S includes each rank with probability 1/2: the null distribution of the signed-rank test, given the ranks.
RankSumTails signed_rank_tails(std::span<const double> ranks, double sum);

}  // namespace stats
