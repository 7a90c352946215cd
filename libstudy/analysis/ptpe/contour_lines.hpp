#pragma once
/// Lines of equal score as polylines, for drawing.

#include <vector>

#include "stats/ptpe/score_grid.hpp"

namespace study {

/// The line on which the mean score is `level`, as polylines over (delta, mu): standard deviation and mean of
/// the frame rate in frames/s. Cells of the grid that lack one of their four nodes are skipped. Each cell is
/// interpolated bilinearly and divided into 12 x 12 pairs of triangles.
std::vector<std::vector<stats::ContourPoint>> contour_polylines(const stats::ScoreGrid& grid, double level);

}  // namespace study
