#include "stats/ptpe/score_grid.hpp"

#include <algorithm>
#include <cmath>

namespace stats {

namespace {

using Node = std::optional<GridNode>;

GridNode between(const GridNode& p, const GridNode& q, double t) {
  return {p.score + (q.score - p.score) * t, p.mu + (q.mu - p.mu) * t, p.delta + (q.delta - p.delta) * t};
}

/// -1, 0 or 1 if the score is below the level, equal to it or above it.
int side(double score, double level) {
  constexpr double equal = 1e-12;
  const double d = score - level;
  return (d > equal) - (d < -equal);
}

std::optional<ContourPoint> crossing(const Node& p, const Node& q, double level) {
  if (!p || !q || side(p->score, level) * side(q->score, level) >= 0) return std::nullopt;
  const auto at = between(*p, *q, (level - p->score) / (q->score - p->score));
  return ContourPoint{at.delta, at.mu};
}

/// The surface of mean scores along a line of constant nominal standard deviation: one node for each row; no
/// nodes if the line lies outside the grid's columns.
std::vector<Node> line_nodes(const ScoreGrid& grid, double delta) {
  const auto right = std::lower_bound(grid.delta.begin(), grid.delta.end(), delta);
  if (right == grid.delta.end() || (right == grid.delta.begin() && delta < *right)) return {};
  const auto column = static_cast<std::size_t>(right - grid.delta.begin());
  std::vector<Node> nodes(grid.mu.size());
  for (std::size_t row = 0; row < grid.mu.size(); ++row) {
    if (delta == *right) {
      nodes[row] = grid.at(row, column);
    } else if (grid.at(row, column - 1) && grid.at(row, column)) {
      const double left = grid.delta[column - 1];
      nodes[row] =
          between(*grid.at(row, column - 1), *grid.at(row, column), (delta - left) / (*right - left));
    }
  }
  return nodes;
}

/// Adds one line's crossings, or counts why it has none.
void add_line(Contour& contour, const std::vector<Node>& nodes) {
  bool neighbours = false, any_above = false, any_below = false;
  std::size_t crossings = 0;
  for (std::size_t row = 0; row + 1 < nodes.size(); ++row) {
    if (!nodes[row] || !nodes[row + 1]) continue;
    neighbours = true;
    for (const auto& node : {nodes[row], nodes[row + 1]}) {
      any_above |= side(node->score, contour.level) > 0;
      any_below |= side(node->score, contour.level) < 0;
    }
    if (const auto point = crossing(nodes[row], nodes[row + 1], contour.level)) {
      contour.points.push_back(*point);
      ++crossings;
    }
  }
  if (!neighbours) return;
  ++contour.lines;
  contour.crossed += crossings > 0;
  contour.crossed_twice += crossings > 1;
  if (crossings > 0) return;
  const bool touches = std::any_of(nodes.begin(), nodes.end(), [&](const Node& node) {
    return node && side(node->score, contour.level) == 0;
  });
  contour.on_node += touches;
  contour.below_grid += !touches && any_above && !any_below;
  contour.above_grid += !touches && any_below && !any_above;
}

}  // namespace

Contour column_crossings(const ScoreGrid& grid, double level, std::span<const double> line_deltas) {
  Contour contour;
  contour.level = level;
  for (const double delta : line_deltas) add_line(contour, line_nodes(grid, delta));
  return contour;
}

std::vector<double> contour_lines(const ScoreGrid& grid) {
  std::vector<double> lines;
  if (grid.delta.empty()) return lines;
  const double first = grid.delta.front(), last = grid.delta.back();
  for (int i = 0; first + i < last; ++i) lines.push_back(first + i);
  lines.push_back(last);
  return lines;
}

Result<ExponentialFit> fit_contour(std::span<const ContourPoint> points) {
  if (points.empty()) return Refusal{"no contour: the mean scores do not cross the level"};
  if (points.size() < 3) {
    return Refusal{"too few contour points: " + std::to_string(points.size()) + ", at least 3 are needed"};
  }
  std::vector<double> delta, mu;
  for (const auto& point : points) {
    delta.push_back(point.delta);
    mu.push_back(point.mu);
  }
  return fit_exponential(delta, mu);
}

}  // namespace stats
