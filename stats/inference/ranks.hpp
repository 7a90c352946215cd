#pragma once
/// Midranks, and exact distributions of sums of ranks. For the rank tests in this folder.

#include <cstddef>
#include <span>
#include <vector>

namespace stats {

struct Midranks {
  std::vector<double> ranks;  ///< in the order of the values, from 1; ties share the mean of theirs
  double tie_sum = 0;         ///< sum over ties of (t^3 - t)
  bool has_ties() const { return tie_sum > 0; }
};

/// None NaN. Equal values share their rank; means and their differences are equal as doubles only when they
/// come from exact_mean.hpp.
Midranks midranks(std::span<const double> values);

/// P(S <= s) and P(S >= s) for a sum S of midranks.
struct RankSumTails {
  double lower = 0, upper = 0;
};

/// S adds each rank with probability 1/2: the signed-rank test's null distribution given the ranks.
RankSumTails signed_rank_tails(std::span<const double> ranks, double sum);

}  // namespace stats
