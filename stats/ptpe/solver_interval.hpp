#pragma once
/// Uncertainty of a and b of the threshold curve mu = a exp(b delta) that a solver uses.

#include <array>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/pilot.hpp"

namespace stats {

/// Intervals of a, frames/s, and b, s/frame.
struct SolverInterval {
  std::array<double, 2> a_ci{}, b_ci{};
  bool spans_contour = false;  ///< false if the contour has no intervals; a_ci and b_ci are then
                               ///< the direct estimate's
};

/// `direct` holds a and b fitted directly to the ratings (direct_fit.hpp), `contour` the intervals of a and b
/// fitted to a contour of the mean ratings (pilot.hpp). The direct estimate has the smaller error, but its
/// intervals reflect chance alone: where the scores are not quadratic, they covered the true b in as few as
/// 84 % of simulated pilots. The contour assumes no shape of the scores and has the larger error. So the
/// solver's intervals span the intervals of both estimates (measured: docs/statistics.md).
SolverInterval solver_interval(const CurveSpread& direct, const Result<PilotSpread>& contour);

}  // namespace stats
