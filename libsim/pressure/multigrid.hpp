#pragma once
/// Geometric multigrid for the slow part of the pressure: -laplace q = C on the cells that hold fluid, q >=
/// 0, q = 0 in the air, no flux through walls.

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

  SIM_FN CellKind kind_at(int x, int y, int z) const {
    if (block.holds(x, y, z)) return kind[block.index(x, y, z)];
    return y >= block.ny ? CellKind::Air : CellKind::Solid;
  }
  /// Finest cells along a cell's edge; the last cell of a row may reach beyond the block.
  SIM_FN float extent(int cell, int finest_cells) const {
    const int left = finest_cells - cell * scale;
    return static_cast<float>(left < scale ? left : scale);
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
  Vec3 conductance_{1, 1, 1};
};

}  // namespace sim::SIM_BACKEND
