#pragma once
/// The pilot's estimates as parts of fit.json.

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "stats/base/json.hpp"

namespace study {

/// a, b, their standard errors and intervals; null where undefined.
void add_estimate(base::Json& json, const MainEstimate& estimate);
/// The direct estimate with jackknife, bootstrap, lack-of-fit test and straight form.
base::Json direct_json(const stats::DirectEstimate& estimate);
/// The contour with its curve and bootstrap.
base::Json contour_estimate_json(const stats::PilotEstimate& estimate);
/// All three estimators at every level, one entry each, with the harmonic mean as predictor.
base::Json estimators_json(const PilotFit& fit);
/// mu(delta) of the direct estimate with pointwise and simultaneous intervals, at every whole frame/s of
/// delta from the smallest to the largest shown, at every level.
base::Json bands_json(const PilotFit& fit);
/// "form": the test of the exponential at the fit's level, and the free curve at every whole frame/s.
base::Json form_json(const PilotFit& fit);
/// The test that tells if the straight form may be used.
base::Json lack_of_fit_json(const stats::DirectEstimate& estimate);

}  // namespace study
