#pragma once
/// Search for lists of whole hold counts near a target distribution of rates, for quantise().
///
/// With N frames, hold k shows at the rate f_k = R / k. Objective: the mean squared difference of the sorted
/// rates, 1/N sum_i (f_k(i) - x_i)^2, which is the squared 2-Wasserstein distance between the two
/// distributions. The list is described by c_k, the number of frames held at most k periods: objective, total
/// time and both sums of rates are then sums of one term for each c_k, and the objective's terms are convex.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// The target of the search.
struct HoldTarget {
  std::vector<double> rates;  ///< x_i, frames/s, descending
  double refresh_hz = 0;      ///< R
  int shortest = 1;           ///< periods
  int longest = 1;            ///< periods, >= shortest
  FpsMean mean_kind = FpsMean::Harmonic;
  double mean = 0;            ///< frames/s
  double mean_tolerance = 0;  ///< frames/s
  double sd = 0;              ///< frames/s
  double sd_tolerance = 0;    ///< frames/s
};

/// A list of holds, in descending rate.
struct HoldList {
  std::vector<int> holds;
  double mean = 0, sd = 0;  ///< frames/s; mean: of the target's mean_kind
  double distance = 0;      ///< root of the objective, frames/s
  double excess = 0;        ///< how far the moments miss their tolerances; 0 = both are met
};

/// The best list found with `total` periods in all (harmonic: this fixes the mean) or, with total = 0, with
/// any total. Deterministic: Lagrange multipliers for both moments, then exchanges of single periods between
/// frames. A list with excess 0 is proof; excess > 0 proves nothing (see sd_bounds for that).
HoldList search_holds(const HoldTarget& target, std::int64_t total);

/// Bounds on the standard deviation of any list, of any length, with exactly the target's mean and holds in
/// its range. Both come from lists of two holds, which are the extreme points of all lists with that mean.
/// low is the smallest deviation of such a pair. high is the square root of the least value, over c, of the
/// largest mean of (rate - c)^2 of a pair, since a variance is the minimum of that mean over c. low > high:
/// no list has that mean.
struct SdBounds {
  double low = 1, high = 0;
};
SdBounds sd_bounds(const HoldTarget& target);

}  // namespace study
