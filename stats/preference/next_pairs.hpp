#pragma once
/// The pairs of conditions whose comparison tells most about a scale of quality (Mikhailiuk et al. 2020,
/// ASAP).

#include <span>
#include <vector>

namespace stats {

/// The pair to ask next, and what one more answer to it is worth.
struct NextPair {
  int first = 0, second = 0;  ///< conditions, first < second
  double bits = 0;            ///< expected information gain
  double probability = 0.5;   ///< expected share of answers for `first`
};

/// The next pairs by expected information gain (Mikhailiuk et al. 2020, ASAP): the mutual information of one
/// answer and the scale. The posterior is taken as normal with mean `jod` and the model's covariance; the
/// gain is then exact, since an answer depends on one difference only. After each choice the covariance
/// counts one answer to the chosen pair, so that the list is a batch. A pair may occur several times.
/// `covariance`: row after row. std::invalid_argument for sizes that do not fit, fewer than two conditions,
/// or a negative `count`.
std::vector<NextPair> next_pairs(std::span<const double> jod, std::span<const double> covariance, int count);

}  // namespace stats
