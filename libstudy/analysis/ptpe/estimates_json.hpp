#pragma once
/// The pilot's estimates of the curve mu(delta) = a exp(b delta) over mean mu and standard deviation delta of
/// the frame rate, as parts of fit.json.

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"

namespace study {

/// Adds to `json` the boolean "converged", and a and b with their standard errors and intervals; null where
/// undefined.
void add_estimate(base::Json& json, const MainEstimate& estimate);
/// The direct estimate (a and b fitted to the ratings, without a contour) with its jackknife and bootstrap.
base::Json direct_json(const stats::DirectEstimate& estimate);
/// The contour estimate: the contour's points, the curve fitted to them, and its bootstrap.
base::Json contour_estimate_json(const stats::PilotEstimate& estimate);
/// A list with one entry for each level and each of the three estimators (direct, contour, ordinal). All use
/// the harmonic mean as predictor.
base::Json estimators_json(const PilotFit& fit);
/// A list of mu(delta) by the direct estimate, with its pointwise and simultaneous interval and the band for
/// the solver. For each level, delta goes from the smallest to the largest shown in steps of 1 frame/s.
/// Levels without a jackknife are left out.
base::Json bands_json(const PilotFit& fit);
/// The entry "form": the test that mu(delta) is an exponential, at the fit's level, and the curve fitted
/// without this assumption, at each 1 frame/s of delta.
base::Json form_json(const PilotFit& fit);
/// The lack-of-fit test of the straight form, with the a and b of this form. The model is E[score] = level +
/// k u + m u delta + q u^2 with u = log mu - log a - b delta; its straight form has m = q = 0. The straight
/// form may be used if p >= 0.05.
base::Json lack_of_fit_json(const stats::DirectEstimate& estimate);

}  // namespace study
