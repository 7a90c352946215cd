#pragma once
/// The pilot's figure (paper Fig. 6): mean scores over (delta, mu), contours at the fit's levels, the fitted
/// curve.

#include <array>
#include <string>
#include <vector>

#include "stats/figures/svg.hpp"
#include "stats/ptpe/score_grid.hpp"

namespace study {

struct PilotFit;

/// The figure's data, from a fit or from its JSON.
struct HeatMap {
  std::string title;
  stats::ScoreGrid grid;
  double scale_min = 1, scale_max = 7;
  std::vector<double> levels;                   ///< of the contours
  std::vector<stats::ContourPoint> points;      ///< points that the curve is fitted to
  std::vector<stats::ContourPoint> free_curve;  ///< by ascending delta; not drawn if empty
  double a = 0, b = 0;                          ///< of mu = a exp(b delta); frames/s and s/frame
  std::array<double, 2> a_ci{}, b_ci{};
  double confidence = 0.95;
  /// JSON pointers to the numbers' sources, written as data-field: to the list of cells and to the estimate;
  /// empty = none.
  std::string cells_field, estimate_field;
};

HeatMap heat_map_of(const PilotFit& fit);  ///< requires fit.ok()
svg::Picture heat_map(const HeatMap& map);
/// A self-contained SVG 1.1 document. Requires fit.ok().
std::string heat_map_svg(const PilotFit& fit);

}  // namespace study
