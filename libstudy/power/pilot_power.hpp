#pragma once
/// Precision with which a pilot determines a and b: the direct estimate (stats/ptpe/direct_fit.hpp) of
/// simulated pilots on the protocol's own plan.

#include <array>
#include <optional>
#include <vector>

#include "libstudy/power/request.hpp"
#include "libstudy/power/studies.hpp"

namespace study {

/// One pilot's estimate of one coefficient, with the jackknife's interval.
struct PilotEstimate {
  double value = 0, se = 0;
  std::array<double, 2> ci{};
  double half_width() const { return (ci[1] - ci[0]) / 2; }
};

struct PilotOutcome {
  bool fitted = false, interval = false;  ///< true if there is an estimate; if there is also an interval
  PilotEstimate a, b;                     ///< valid if `interval`
};

/// Indexed by number of participants as PowerRequest::n, then by study.
using PilotOutcomes = std::vector<std::vector<PilotOutcome>>;

/// One coefficient at one number of participants. All but `sd` and `mean` refer to the jackknife's interval,
/// over the pilots that have one.
struct CoefficientPoint {
  Estimated mean;               ///< of the estimates
  Estimated sd;                 ///< of the estimates: the true standard error
  Estimated se;                 ///< median of the pilots' standard errors
  Estimated half_width;         ///< median half width of the interval
  Estimated half_width_wished;  ///< quantile of the half widths at the requested power
  Estimated coverage;           ///< share of intervals that cover the truth
  /// Share of all pilots whose half width reaches the requested precision; a pilot without an interval does
  /// not.
  std::optional<Estimated> reached;
};

struct PilotPoint {
  Estimated fitted;                      ///< share of pilots with an estimate
  Estimated interval;                    ///< share of pilots with an interval
  std::optional<CoefficientPoint> a, b;  ///< empty if fewer than two pilots have an interval
};

struct PilotPower {
  std::vector<PilotPoint> curve;  ///< as PowerRequest::n
  /// The smallest n from which on every requested n reaches the precision with the requested power; for the
  /// medians, with the median half width, that is, in half of the pilots.
  std::optional<int> n_for_a, n_for_b, n_for_both;
  std::optional<int> n_for_a_median, n_for_b_median;
};

/// Simulates these pilots with each number of participants. The result does not depend on the number of
/// threads. base::Error unless the protocol asks one scale about each setting.
PilotOutcomes simulate_pilots(const PowerRequest& request, StudyRange studies);

/// Summarises all pilots of the request.
PilotPower pilot_power(const PowerRequest& request, const PilotOutcomes& pilots);

/// Simulates and summarises, in one process.
PilotPower simulate_pilot_power(const PowerRequest& request);

}  // namespace study
