#pragma once
/// The pilot's figure (paper Fig. 6): mean scores over (delta, mu), contours at 4.0 and 5.0, the fitted
/// curve.

#include <string>

#include "apps/stats/pilot_fit.hpp"

namespace apps {

/// A self-contained SVG 1.1 document. The fit is ok().
std::string heat_map_svg(const PilotFit& fit);

}  // namespace apps
