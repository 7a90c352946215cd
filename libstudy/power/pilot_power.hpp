#pragma once
/// Computes how precisely a pilot determines the coefficients a and b of the curve mu = a exp(b delta) over
/// mean mu and standard deviation delta of the frame rate. Pilots with the protocol's plan are simulated and
/// fitted by the direct estimate (stats/ptpe/direct_fit.hpp).

#include <array>
#include <optional>
#include <vector>

#include "libstudy/power/request.hpp"
#include "libstudy/power/studies.hpp"

namespace study {

/// One pilot's estimate of a or b, with standard error and interval by the jackknife.
struct PilotEstimate {
  double value = 0, se = 0;
  std::array<double, 2> ci{};
  double half_width() const { return (ci[1] - ci[0]) / 2; }
};

struct PilotOutcome {
  bool fitted = false, interval = false;  ///< true if there is an estimate; true if there is an interval too
  PilotEstimate a, b;                     ///< valid if `interval`
};

/// First index: number of participants, as in PowerRequest::n. Second index: study.
using PilotOutcomes = std::vector<std::vector<PilotOutcome>>;

/// One coefficient at one number of participants, summarised over the simulated pilots with a jackknife
/// interval.
struct CoefficientPoint {
  Estimated mean;               ///< mean of the estimates
  Estimated sd;                 ///< standard deviation of the estimates: the true standard error of one pilot
  Estimated se;                 ///< median of the pilots' standard errors
  Estimated half_width;         ///< median half width of the interval
  Estimated half_width_wished;  ///< quantile of the half widths: a share PowerRequest::power of the intervals
                                ///< has at most this half width
  Estimated coverage;           ///< share of intervals that cover the truth
  /// Share of all pilots whose half width is at most the requested precision. A pilot without an interval
  /// counts as failed.
  std::optional<Estimated> reached;
};

struct PilotPoint {
  Estimated fitted;                      ///< share of pilots with an estimate
  Estimated interval;                    ///< share of pilots with an interval
  std::optional<CoefficientPoint> a, b;  ///< empty if fewer than two pilots have an interval
};

struct PilotPower {
  std::vector<PilotPoint> curve;  ///< one point for each of PowerRequest::n
  /// The smallest requested n such that, at this n and at every larger requested n, a certain share of pilots
  /// reaches the requested precision. This share is PowerRequest::power; for n_for_a_median and
  /// n_for_b_median it is one half. n_for_both is the larger of n_for_a and n_for_b.
  std::optional<int> n_for_a, n_for_b, n_for_both;
  std::optional<int> n_for_a_median, n_for_b_median;
};

/// Simulates the pilots in `studies` with each number of participants. The result does not depend on the
/// number of threads. base::Error if the trials do not ask the requested scale, or if the level lies outside
/// the scale.
PilotOutcomes simulate_pilots(const PowerRequest& request, StudyRange studies);

/// Summarises the outcomes of all pilots of the request.
PilotPower pilot_power(const PowerRequest& request, const PilotOutcomes& pilots);

/// Simulates all pilots of the request and summarises their outcomes.
PilotPower simulate_pilot_power(const PowerRequest& request);

}  // namespace study
