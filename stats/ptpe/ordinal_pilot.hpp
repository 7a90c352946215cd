#pragma once
/// Estimates a and b of the threshold curve mu = a exp(b delta) of mean frame rates mu over standard
/// deviations delta, by an ordinal mixed model: ratings as ordered categories, people as a random effect. The
/// location depends on mu and delta as the score does in the direct estimate (stats/ptpe/direct_fit.hpp).
///
///   P(Y <= j) = Phi(theta_j - k u - m u delta - q u^2 - s_p),  s_p ~ N(0, sd^2)
///   u = log mu - log a - b delta
///
/// with the thresholds constrained so that E[Y] = level at u = 0 over the population of participants. Scores
/// need not be equally spaced. The location needs no curvature at the ends of the scale, since the thresholds
/// bound the scores.

#include <span>
#include <vector>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// A fit of the model at the top of this file, with u = log mu - log a - b delta for a mean mu and standard
/// deviation delta of the frame rate.
struct OrdinalPilotFit {
  Curve curve;
  double level = 4;
  double k = 0, m = 0, q = 0;  ///< coefficients of the location k u + m u delta + q u^2, on the probit scale
  double sd_participant = 0;
  std::vector<double> levels, thresholds;
  double log_likelihood = 0;
  int n = 0;
};

/// Maximum likelihood with adaptive quadrature of `points` nodes (1 = Laplace), started from the direct fit.
/// Repeated ratings enter one by one. Refused: no ratings; no direct fit to start from; all scores equal; the
/// level not between the lowest and the highest score given; no convergence; scores that do not rise with the
/// frame rate along the curve.
Result<OrdinalPilotFit> fit_ordinal_pilot(std::span<const PilotRating> ratings, PilotMean mean, double level,
                                          int points = 1);

struct OrdinalPilotEstimate {
  Result<OrdinalPilotFit> fit = Refusal{"not computed"};
  Result<CurveSpread> jackknife = Refusal{"not computed"};
  /// Nominal standard deviations of the frame rate that within_reach() excludes.
  std::vector<double> out_of_reach;
};

/// The fit to the settings within reach (direct_fit.hpp) and its jackknife over participants, which takes one
/// more fit for each participant.
OrdinalPilotEstimate estimate_ordinal_pilot(std::span<const PilotRating> ratings, PilotMean mean,
                                            double level, double confidence);

}  // namespace stats
