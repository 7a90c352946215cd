#pragma once
/// How precisely a pilot determines a and b: the direct estimate (stats/ptpe/direct_fit.hpp) of simulated
/// pilots on the protocol's own plan.

#include <optional>
#include <vector>

#include "apps/stats/power/request.hpp"
#include "apps/stats/power/studies.hpp"

namespace apps {

/// One coefficient at one number of participants. All but `sd` and `mean` are of the jackknife's interval and
/// over the pilots that have one.
struct CoefficientPoint {
  Estimated mean;               ///< of the estimates
  Estimated sd;                 ///< of the estimates: the true standard error
  Estimated se;                 ///< median of the standard errors that the pilots state
  Estimated half_width;         ///< median half width of the interval
  Estimated half_width_wished;  ///< quantile of the half widths at the power wished
  Estimated coverage;           ///< share of intervals that hold the truth
  /// Share of all pilots whose half width reaches the precision wished; a pilot without an interval does not.
  std::optional<Estimated> reached;
};

struct PilotPoint {
  Estimated fitted;                      ///< share of pilots with an estimate
  Estimated interval;                    ///< share of pilots with an interval
  std::optional<CoefficientPoint> a, b;  ///< none where fewer than two pilots have an interval
};

struct PilotPower {
  std::vector<PilotPoint> curve;  ///< as PowerRequest::n
  /// The first n from which, at every n asked for, the precision is reached with the power wished; by the
  /// median half width, in half of the pilots.
  std::optional<int> n_for_a, n_for_b, n_for_both;
  std::optional<int> n_for_a_median, n_for_b_median;
};

/// Equal for any number of threads. base::Error unless the protocol asks one scale about each setting.
PilotPower simulate_pilot_power(const PowerRequest& request);

}  // namespace apps
