#pragma once
/// Contours as lines to draw.

#include <vector>

#include "stats/ptpe/score_grid.hpp"

namespace apps {

/// The contour over every cell that has its four nodes, as polylines in frames/s. Each cell's patch is cut
/// into 12 x 12 pairs of triangles.
std::vector<std::vector<stats::ContourPoint>> contour_polylines(const stats::ScoreGrid& grid, double level);

}  // namespace apps
