#pragma once
/// How far a pilot leaves open the a and b that a solver gets.

#include <array>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/pilot.hpp"

namespace stats {

/// Intervals of a, frames/s, and b, s/frame.
struct SolverInterval {
  std::array<double, 2> a_ci{}, b_ci{};
  bool spans_contour = false;  ///< false: the contour has none, and these are the direct estimate's
};

/// The direct estimate has the smaller error, but an interval that knows of chance alone: where the scores
/// are no quadratic it held b in as few as 84 %. The contour assumes no shape of the scores and has the
/// larger error. So the intervals reach over both (measured: docs/statistics.md).
SolverInterval solver_interval(const CurveSpread& direct, const Result<PilotSpread>& contour);

}  // namespace stats
