#pragma once
/// mu(delta) = a exp(b delta) from a model that knows where the rating scale ends: the bands of the solver's
/// file.
///
///   E[score] = S(x),   x = x0 + k u + m u e + q u^2,   u = (sqrt(mu) - sqrt(a exp(b delta))) 2 / sqrt(M)
///
/// S(x) is the mean of a rating that is x with a normal error, rounded to a whole score and held within the
/// scale. S(x0) is the level, e is delta less its mean in tens of frames/s, and M is the geometric mean of
/// the frame rates. The direct estimate (direct_fit.hpp) has no S: it follows the scores that level off at
/// the ends of the scale, and its curve is up to half a standard error off. The square root lies between
/// scores that rise with the frame rate and scores that rise with its logarithm: a quadratic in it comes near
/// to both.

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

/// The solver's file states its intervals at this confidence.
inline constexpr double solver_confidence = 0.95;

/// Least squares over all settings but those at direct.out_of_reach, from the direct estimate's curve, with
/// the jackknife over participants. The standard deviation of the normal error is that of the ratings of one
/// setting, pooled over settings whose mean score lies in the middle half of the scale, less that of the
/// rounding. Refused: without a direct fit; fewer than least_participants; a level outside the scale; ratings
/// of such settings that do not differ; a search that does not end; scores that do not rise along the curve,
/// for all participants or without one of them.
Result<CurveSpread> scale_end_curve(std::span<const PilotObservation> observations,
                                    const DirectEstimate& direct, double level, const ScaleEnds& ends);

}  // namespace stats
