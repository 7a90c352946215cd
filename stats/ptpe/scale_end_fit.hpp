#pragma once
/// Estimates the threshold curve mu(delta) = a exp(b delta) of mean frame rates mu over standard deviations
/// delta by a model of the bounded rating scale. The bands in the solver's file come from this estimate.
///
///   E[score] = S(x),   x = x0 + k u + m u e + q u^2,   u = (sqrt(mu) - sqrt(a exp(b delta))) 2 / sqrt(M)
///
/// S(x) is the mean of a rating that is x plus a normal error, rounded to a whole score and clamped to the
/// scale. S(x0) is the level, e is delta minus its mean in tens of frames/s, and M is the geometric mean of
/// the frame rates. The direct estimate (direct_fit.hpp) has no S: it follows the scores that level off at
/// the ends of the scale, so its curve is biased (docs/statistics.md). A quadratic in the square root
/// approximates both scores that rise with the frame rate and scores that rise with its logarithm.

#include <span>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// Lowest and highest score.
struct ScaleEnds {
  double lowest = 1, highest = 7;
};

/// Confidence of the intervals in the solver's file.
inline constexpr double solver_confidence = 0.95;

/// Least squares over all settings except those at direct.out_of_reach, started from the direct estimate's
/// curve, with the jackknife over participants. The variance of the normal error is the pooled variance of
/// ratings within one setting, over settings whose mean score lies in the middle half of the scale, minus
/// that of rounding, and at least 0.1. Refused: no direct fit; fewer than least_participants; a level that is
/// not inside the scale; all ratings equal within each setting used for that variance; a search that does not
/// converge; scores that do not rise along the curve, for all participants or without one of them.
Result<CurveSpread> scale_end_curve(std::span<const PilotObservation> observations,
                                    const DirectEstimate& direct, double level, const ScaleEnds& ends);

}  // namespace stats
