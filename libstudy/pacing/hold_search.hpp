#pragma once
/// Search for a list of holds whose frame rates are near a target distribution, for quantise().
///
/// A hold is the number k of refresh periods for which a frame is shown. At the refresh rate R the frame then
/// has the rate f_k = R / k. Objective for N frames: the mean squared difference of the sorted rates, 1/N
/// sum_i (f_k(i) - x_i)^2. This is the squared 2-Wasserstein distance between the list and the target rates
/// x_i. The search describes a list by c_k, the number of frames held at most k periods: the objective, the
/// total time and the sums of rates and of squared rates each have one term per c_k, and the objective's
/// terms are convex.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// The target of the search: rates and their moments, and the range of holds.
struct HoldTarget {
  std::vector<double> rates;  ///< x_i, frames/s, descending
  double refresh_hz = 0;      ///< refresh rate R, Hz
  int shortest = 1;           ///< shortest hold, periods
  int longest = 1;            ///< longest hold, periods, >= shortest
  FpsMean mean_kind = FpsMean::Harmonic;
  double mean = 0;            ///< frames/s
  double mean_tolerance = 0;  ///< frames/s
  double sd = 0;              ///< frames/s
  double sd_tolerance = 0;    ///< frames/s
};

/// A list of holds, from the highest rate to the lowest.
struct HoldList {
  std::vector<int> holds;
  double mean = 0, sd = 0;  ///< of the rates, frames/s; mean of the target's mean_kind
  double distance = 0;      ///< root of the objective, frames/s
  /// Sum of the errors of mean and sd beyond their tolerances, frames/s. 0: both are within their tolerances.
  double excess = 0;
};

/// Searches for a list with excess 0 and a small objective. total: number of periods to which the holds sum
/// (this fixes a harmonic mean); 0: any sum. If no list with excess 0 is found, returns the list with the
/// least excess, for total = 0 that with the least error of the mean; an excess is infinite if the sum is not
/// `total`. Deterministic: Lagrange multipliers for both moments, then exchanges of single periods between
/// frames. Excess 0 proves that the target can be met. Excess > 0 does not prove that the target cannot be
/// met; sd_bounds() may prove it.
HoldList search_holds(const HoldTarget& target, std::int64_t total);

/// Bounds of the standard deviation, frames/s, of every list of any length with exactly the target's mean and
/// holds from shortest to longest. Both bounds come from lists with two different holds, which are the
/// extreme points of the set of all lists with this mean. low: the smallest standard deviation of these
/// pairs. high^2: the minimum over c of the largest mean of (rate - c)^2 among the pairs, because a variance
/// is the minimum over c of the mean of (rate - c)^2. low > high: no list has this mean.
struct SdBounds {
  double low = 1, high = 0;
};
SdBounds sd_bounds(const HoldTarget& target);

}  // namespace study
