#pragma once
/// Contours as polylines for drawing.

#include <vector>

#include "stats/ptpe/score_grid.hpp"

namespace study {

/// The contour over every cell with all four nodes, as polylines in frames/s. Each cell's patch is divided
/// into 12 x 12 pairs of triangles.
std::vector<std::vector<stats::ContourPoint>> contour_polylines(const stats::ScoreGrid& grid, double level);

}  // namespace study
