#include "libstudy/analysis/ptpe/contour_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace study {

namespace {

using stats::ContourPoint;
using stats::GridNode;
using stats::ScoreGrid;
using Polyline = std::vector<ContourPoint>;

constexpr int pieces = 12;  // number of parts into which each side of a grid cell is divided

/// A side of a small triangle: the ids of its two corners, the smaller id first. Two neighbouring triangles
/// have one Side in common.
using Side = std::pair<std::size_t, std::size_t>;

struct Corner {
  std::size_t id;
  GridNode node;
};

/// Bilinear interpolation of mu, delta and score between four nodes, at (s, t) in [0, 1]^2.
GridNode patch(const std::array<GridNode, 4>& corner, double s, double t) {
  const std::array<double, 4> w{(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  GridNode node;
  for (std::size_t i = 0; i < 4; ++i) {
    node.score += w[i] * corner[i].score;
    node.mu += w[i] * corner[i].mu;
    node.delta += w[i] * corner[i].delta;
  }
  return node;
}

/// The contour as single segments, one within each small triangle that it crosses. `at`: the point at which
/// the contour crosses a side. `joined`: for each side, the sides that a segment connects with it.
struct Pieces {
  std::map<Side, ContourPoint> at;
  std::map<Side, std::vector<Side>> joined;

  void add(const std::array<Corner, 3>& triangle, double level) {
    std::vector<Side> ends;
    for (std::size_t i = 0; i < 3; ++i) {
      auto p = triangle[i], q = triangle[(i + 1) % 3];
      if ((p.node.score < level) == (q.node.score < level)) continue;
      if (p.id > q.id) std::swap(p, q);
      const double t = (level - p.node.score) / (q.node.score - p.node.score);
      const Side side{p.id, q.id};
      at[side] = {std::lerp(p.node.delta, q.node.delta, t), std::lerp(p.node.mu, q.node.mu, t)};
      ends.push_back(side);
    }
    if (ends.size() != 2) return;
    joined[ends[0]].push_back(ends[1]);
    joined[ends[1]].push_back(ends[0]);
  }

  /// Follows the segments in `joined` from a side to their end, removes them and returns them as one line.
  Polyline take(Side side) {
    Polyline line{at[side]};
    while (!joined[side].empty()) {
      const Side next = joined[side].back();
      joined[side].pop_back();
      std::erase(joined[next], side);
      line.push_back(at[next]);
      side = next;
    }
    return line;
  }
};

void add_cell(Pieces& found, const ScoreGrid& grid, std::size_t row, std::size_t column, double level) {
  const auto &a = grid.at(row, column), &b = grid.at(row, column + 1);
  const auto &c = grid.at(row + 1, column), &d = grid.at(row + 1, column + 1);
  if (!a || !b || !c || !d) return;
  const std::size_t width = (grid.delta.size() - 1) * pieces + 1;
  const auto corner = [&](std::size_t i, std::size_t j) {
    return Corner{(row * pieces + j) * width + column * pieces + i,
                  patch({*a, *b, *c, *d}, static_cast<double>(i) / pieces, static_cast<double>(j) / pieces)};
  };
  for (std::size_t i = 0; i < pieces; ++i) {
    for (std::size_t j = 0; j < pieces; ++j) {
      found.add({corner(i, j), corner(i + 1, j), corner(i, j + 1)}, level);
      found.add({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)}, level);
    }
  }
}

}  // namespace

std::vector<Polyline> contour_polylines(const ScoreGrid& grid, double level) {
  Pieces found;
  for (std::size_t row = 0; row + 1 < grid.mu.size(); ++row) {
    for (std::size_t column = 0; column + 1 < grid.delta.size(); ++column)
      add_cell(found, grid, row, column, level);
  }
  std::vector<Side> ends, all;
  for (const auto& [side, others] : found.joined) (others.size() == 1 ? ends : all).push_back(side);
  std::vector<Polyline> lines;
  // Open lines are followed first, from one of their ends. The remaining segments form closed loops.
  ends.insert(ends.end(), all.begin(), all.end());
  for (const auto& side : ends) {
    if (!found.joined[side].empty()) lines.push_back(found.take(side));
  }
  return lines;
}

}  // namespace study
