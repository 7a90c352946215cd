#pragma once
/// The pilot's figure (paper Fig. 6): mean scores over (delta, mu), contours at 4.0 and 5.0, the fitted
/// curve.

#include <array>
#include <string>
#include <vector>

#include "apps/common/svg.hpp"
#include "stats/ptpe/score_grid.hpp"

namespace apps {

struct PilotFit;

/// What the figure shows, whether it comes from a fit or from its JSON.
struct HeatMap {
  std::string title;
  stats::ScoreGrid grid;
  double scale_min = 1, scale_max = 7;
  std::vector<double> levels;                   ///< of the contours
  std::vector<stats::ContourPoint> points;      ///< that the curve goes through
  std::vector<stats::ContourPoint> free_curve;  ///< by ascending delta; empty: not drawn
  double a = 0, b = 0;                          ///< of mu = a exp(b delta); frames/s and s/frame
  std::array<double, 2> a_ci{}, b_ci{};
  double confidence = 0.95;
  /// JSON pointers behind the numbers, written as data-field: of the list of cells and of the estimate; empty
  /// = none.
  std::string cells_field, estimate_field;
};

HeatMap heat_map_of(const PilotFit& fit);  ///< the fit is ok()
svg::Picture heat_map(const HeatMap& map);
/// A self-contained SVG 1.1 document. The fit is ok().
std::string heat_map_svg(const PilotFit& fit);

}  // namespace apps
