#pragma once
/// The pilot's figure (paper Fig. 6) shows mean scores over (delta, mu), that is, standard deviation and mean
/// of the frame rate; contours at the fit's levels; and the fitted curve.

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
  std::vector<double> levels;               ///< scores at which contours are drawn
  std::vector<stats::ContourPoint> points;  ///< points of the contour, to which the contour's curve is fitted
  /// Curve fitted without the assumption of an exponential, by ascending delta; empty: not drawn.
  std::vector<stats::ContourPoint> free_curve;
  double a = 0, b = 0;  ///< coefficients of the curve mu = a exp(b delta): a in frames/s, b in s/frame
  std::array<double, 2> a_ci{}, b_ci{};
  double confidence = 0.95;
  /// JSON pointers to the list of cells and to the estimate in the results. Each number of the figure has its
  /// JSON pointer as attribute data-field; empty: no attribute.
  std::string cells_field, estimate_field;
};

HeatMap heat_map_of(const PilotFit& fit);  ///< requires fit.ok()
svg::Picture heat_map(const HeatMap& map);
/// A self-contained SVG 1.1 document. Requires fit.ok().
std::string heat_map_svg(const PilotFit& fit);

}  // namespace study
