#pragma once
/// The pilot's estimates as parts of fit.json.

#include <nlohmann/json_fwd.hpp>

#include "apps/stats/ptpe/pilot_fit.hpp"

namespace apps {

/// a, b, their standard errors and intervals; null where undefined.
void add_estimate(nlohmann::ordered_json& json, const MainEstimate& estimate);
/// The direct estimate with jackknife, bootstrap, lack-of-fit test and straight form.
nlohmann::ordered_json direct_json(const stats::DirectEstimate& estimate);
/// The contour with its curve and bootstrap.
nlohmann::ordered_json contour_estimate_json(const stats::PilotEstimate& estimate);
/// All three at every level, one entry each, the harmonic mean as predictor.
nlohmann::ordered_json estimators_json(const PilotFit& fit);
/// mu(delta) of the direct estimate with pointwise and simultaneous intervals, at every whole frame/s of
/// delta from the smallest to the largest shown, at every level.
nlohmann::ordered_json bands_json(const PilotFit& fit);
/// May the straight form be used? At the level wished.
/// "form": the test of the exponential at the level wished, and the free curve at every whole frame/s.
nlohmann::ordered_json form_json(const PilotFit& fit);
nlohmann::ordered_json lack_of_fit_json(const stats::DirectEstimate& estimate);

}  // namespace apps
