#pragma once
/// Geometric multigrid for the slow part of the pressure: -laplace q = C on the cells that hold fluid, q >=
/// 0, q = 0 in the air and outside open faces, no flux through walls.

#include <vector>

#include "libsim/particles/cells.hpp"

namespace sim::SIM_BACKEND {

enum class CellKind : std::uint8_t { Air, Fluid, Solid };

/// One grid as kernels see it. The equation of a fluid cell is the sum of conductance (q_i - q_j) over its
/// six neighbours j that are not solid = source_i.
struct GridView {
  CellBlock block, finest;
  Vec3 conductance;  ///< of a finest cell's faces across x, y, z; 1 for cubes
  int scale;         ///< edge of a cell in finest cells
  CellKind* kind;
  float* q;
  float* source;
  const OpenFace* open;
  int open_count;

  SIM_FN CellKind kind_at(int x, int y, int z) const {
    if (block.holds(x, y, z)) return kind[block.index(x, y, z)];
    return y >= block.ny ? CellKind::Air : CellKind::Solid;
  }
  /// Finest cells along a cell's edge; the last cell of a row may reach beyond the block.
  SIM_FN float extent(int cell, int finest_cells) const {
    const int left = finest_cells - cell * scale;
    return static_cast<float>(left < scale ? left : scale);
  }
  /// Conductance of the face between the block and this place outside it, of one inside. The water outside
  /// has q = 0 at one finest cell beyond the last one's centre, on every grid.
  SIM_FN float openness(int x, int y, int z) const {
    float share = 0;
    for (int o = 0; o < open_count; ++o) share += share_of(open[o], x, y, z);
    if (share <= 0) return 0;
    const auto way = static_cast<float>(scale);
    return way / (0.5f * (way - 1) + 1 / fminf(share, 1.0f));
  }
  /// Share of an open face in that face.
  SIM_FN float share_of(const OpenFace& face, int x, int y, int z) const {
    const int place[3] = {x, y, z};
    const int cells[3] = {block.nx, block.ny, block.nz};
    const int fine[3] = {finest.nx, finest.ny, finest.nz};
    if (place[face.axis] != (face.at_high ? cells[face.axis] : -1)) return 0;
    float share = 1;
    for (int k = 0, along = 0; k < 3; ++k) {
      if (k == face.axis) continue;
      if (place[k] < 0 || place[k] >= cells[k]) return 0;
      const auto low = static_cast<float>(place[k] * scale);
      const float wide = extent(place[k], fine[k]);
      share *= fmaxf(fminf(face.high[along], low + wide) - fmaxf(face.low[along], low), 0.0f) / wide;
      ++along;
    }
    return share;
  }
  /// 0 in air, walls and outside.
  SIM_FN float q_at(int x, int y, int z) const {
    return block.holds(x, y, z) ? q[block.index(x, y, z)] : 0.0f;
  }
};

struct SmallGrids;

class Multigrid {
 public:
  /// Makes room for a finest grid of this many cells and its coarser ones. Cheap when nothing changed. The
  /// conductance of a face is its area over the way across it.
  void fit(CellBlock finest, Vec3 conductance = {1, 1, 1});
  /// Opens these faces of the finest grid, and shuts all others.
  void open(const std::vector<OpenFace>& faces) { open_.from_host(faces); }
  /// The finest grid. Write kind and source (C times the volume of each fluid cell, in the unit of
  /// conductances), then solve.
  GridView finest() { return view(0); }
  /// Runs V-cycles from q = 0.
  void solve(int cycles);

 private:
  struct Level {
    CellBlock block;
    Array<CellKind> kind;
    Array<float> q, source;
  };

  GridView view(std::size_t level);
  /// The first of the grids that one block handles together, and these.
  std::size_t first_small() const;
  SmallGrids small_grids();

  void cycle(std::size_t level);
  void smooth(std::size_t level, int first_colour);

  std::vector<Level> levels_;
  Array<OpenFace> open_;
  Vec3 conductance_{1, 1, 1};
};

}  // namespace sim::SIM_BACKEND
