#pragma once
/// How precisely a pilot determines a and b: the direct estimate (stats/ptpe/direct_fit.hpp) of simulated
/// pilots on the protocol's own plan.

#include <array>
#include <optional>
#include <vector>

#include "apps/stats/power/request.hpp"
#include "apps/stats/power/studies.hpp"

namespace apps {

/// One pilot's estimate of one coefficient, with the jackknife's interval.
struct PilotEstimate {
  double value = 0, se = 0;
  std::array<double, 2> ci{};
  double half_width() const { return (ci[1] - ci[0]) / 2; }
};

struct PilotOutcome {
  bool fitted = false, interval = false;  ///< has an estimate; has an interval too
  PilotEstimate a, b;                     ///< where there is an interval
};

/// By number of participants as PowerRequest::n, then by study.
using PilotOutcomes = std::vector<std::vector<PilotOutcome>>;

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

/// Simulates these pilots with each number of participants. Equal for any number of threads. base::Error
/// unless the protocol asks one scale about each setting.
PilotOutcomes simulate_pilots(const PowerRequest& request, StudyRange studies);

/// What all of the request's pilots say.
PilotPower pilot_power(const PowerRequest& request, const PilotOutcomes& pilots);

/// Both, in one process.
PilotPower simulate_pilot_power(const PowerRequest& request);

}  // namespace apps
