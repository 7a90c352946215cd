#pragma once
/// Mean scores over (mu, delta), the mean and the standard deviation of the frame rate, interpolated
/// bilinearly between the settings, and their contours (ViP-Fluid paper, section 4.2, Fig. 6).

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stats/ptpe/exponential_fit.hpp"
#include "stats/result.hpp"

namespace stats {

/// Means over participants at one setting.
struct GridNode {
  double score = 0;  ///< mean over participants
  double mu = 0;     ///< mean of the frame rate as shown, frames/s; delta is its standard deviation
  double delta = 0;
};

/// The settings by their nominal values: rows are means, columns are standard deviations. The surface is the
/// isoparametric bilinear patch over each cell with all four nodes: score, mu and delta are interpolated with
/// the same weights. If the mu and delta shown differ slightly from the nominal ones, lines of constant
/// nominal delta bend; otherwise the interpolation is plainly bilinear.
struct ScoreGrid {
  std::vector<double> mu, delta;               ///< nominal, ascending, frames/s
  std::vector<std::optional<GridNode>> nodes;  ///< row-major, mu.size() x delta.size()

  const std::optional<GridNode>& at(std::size_t row, std::size_t column) const {
    return nodes[row * delta.size() + column];
  }
};

struct ContourPoint {
  double delta = 0, mu = 0;  ///< frames/s
};

/// A contour of the mean scores over mean frame rates mu and standard deviations delta, sampled along lines
/// of constant nominal delta.
struct Contour {
  double level = 0;
  std::vector<ContourPoint> points;  ///< ordered by line, then by ascending mu
  int lines = 0;                     ///< sampled lines that have at least two neighbouring scores
  int crossed = 0;                   ///< of these, lines with at least one crossing
  int crossed_twice = 0;             ///< lines with two or more crossings: the scores are not monotone in mu
  int below_grid = 0;  ///< lines with every score above the level: the contour lies below the smallest mu
  int above_grid = 0;  ///< lines with every score below the level: the contour lies above the largest mu
  int on_node = 0;     ///< lines without a crossing on which the score at a row equals the level
};

/// Finds where the scores cross the level along the given lines. It skips lines outside the grid's columns. A
/// crossing lies between two neighbouring scores, one above and one below the level. A score equal to the
/// level (to 1e-12) is not a crossing; a line that has such a score and no crossing is counted in on_node.
Contour column_crossings(const ScoreGrid& grid, double level, std::span<const double> line_deltas);
/// Nominal standard deviations of the lines: from the grid's first column on in steps of 1 frame/s, and the
/// last column.
std::vector<double> contour_lines(const ScoreGrid& grid);

/// Fits mu = a exp(b delta) to the contour's points. Refused: fewer than three points, or as in
/// fit_exponential().
Result<ExponentialFit> fit_contour(std::span<const ContourPoint> points);

}  // namespace stats
