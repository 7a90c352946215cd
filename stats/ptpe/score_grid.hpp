#pragma once
/// Mean scores over (mu, delta), bilinear between the settings, and their contours (paper section 4.2, Fig.
/// 6).

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stats/ptpe/exponential_fit.hpp"
#include "stats/result.hpp"

namespace stats {

/// What is known at one setting.
struct GridNode {
  double score = 0;  ///< mean over participants
  double mu = 0;     ///< where the setting really lay: mean frame rate and its standard deviation, frames/s
  double delta = 0;
};

/// The settings by their nominal values: rows are means, columns are standard deviations.
/// The surface is the isoparametric bilinear patch over each cell whose four nodes are there: score, mu and
/// delta are interpolated alike, so nodes that lie slightly off their nominal place bend the lines and lose
/// nothing, and nodes at their nominal place give plain bilinear interpolation.
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

/// A contour sampled along lines of constant nominal delta.
struct Contour {
  double level = 0;
  std::vector<ContourPoint> points;  ///< by line, then by ascending mu
  int lines = 0;                     ///< sampled lines that have at least two neighbouring scores
  int crossed = 0;                   ///< of them: with at least one crossing
  int crossed_twice = 0;             ///< with two or more: the scores are not monotone in mu
  int below_grid = 0;                ///< every score above the level: the contour lies below the smallest mu
  int above_grid = 0;                ///< every score below the level: it lies above the largest mu
  int on_node = 0;                   ///< the level is met at a setting itself and nowhere crossed
};

/// Crossings are strict: one score above, one below the level. A score equal to the level (to 1e-12) is no
/// crossing; the line is then counted in on_node.
/// Where the grid's edges cross the level, by ascending delta, then mu: the sparse contour.
std::vector<ContourPoint> edge_crossings(const ScoreGrid& grid, double level);
/// Crossings along the lines given; those outside the grid's columns are passed over.
Contour column_crossings(const ScoreGrid& grid, double level, std::span<const double> line_deltas);
/// Nominal lines at every whole frame/s from the first column to the last, and at the last.
std::vector<double> contour_lines(const ScoreGrid& grid);

/// mu = a exp(b delta) through the contour's points. Refused: no point, or fewer than three.
Result<ExponentialFit> fit_contour(std::span<const ContourPoint> points);

}  // namespace stats
