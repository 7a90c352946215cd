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
  float* q;  ///< 0 where there is no fluid
  float* source;
  float* diagonal;  ///< of a fluid cell's equation: the sum of its conductances
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
    return quotient(way, 0.5f * (way - 1) + reciprocal(fminf(share, 1.0f)));
  }
  /// Share of an open face in that face.
  SIM_FN float share_of(const OpenFace& face, int x, int y, int z) const {
    const int across = face.axis == 0 ? x : face.axis == 1 ? y : z;
    const int cells = face.axis == 0 ? block.nx : face.axis == 1 ? block.ny : block.nz;
    if (across != (face.at_high ? cells : -1)) return 0;
    const float first =
        face.axis == 0 ? covered(face, 0, y, block.ny, finest.ny) : covered(face, 0, x, block.nx, finest.nx);
    const float second =
        face.axis == 2 ? covered(face, 1, y, block.ny, finest.ny) : covered(face, 1, z, block.nz, finest.nz);
    return first * second;
  }
  /// Share of the face in a cell's extent along one of its two axes.
  SIM_FN float covered(const OpenFace& face, int along, int cell, int cells, int finest_cells) const {
    if (cell < 0 || cell >= cells) return 0;
    const auto low = static_cast<float>(cell * scale);
    const float wide = extent(cell, finest_cells);
    const float both = fminf(face.high[along], low + wide) - fmaxf(face.low[along], low);
    return quotient(fmaxf(both, 0.0f), wide);
  }
  /// 0 in air, walls and outside.
  SIM_FN float q_at(int x, int y, int z) const {
    return block.holds(x, y, z) ? q[block.index(x, y, z)] : 0.0f;
  }
};

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
  /// Grids below the first small one live in scratch memory and have no columns.
  struct Level {
    CellBlock block;
    Array<CellKind> kind;
    Array<float> q, source, diagonal;
  };

  GridView view(std::size_t level);
  /// The first of the grids that one block handles together.
  std::size_t first_small() const;

  void cycle(std::size_t level);
  /// V-cycles over the small grids, from q = 0.
  void cycle_small(int cycles);
  void smooth(std::size_t level, int first_colour);

  std::vector<Level> levels_;
  Array<OpenFace> open_;
  Array<unsigned char> room_;
  Vec3 conductance_{1, 1, 1};
};

}  // namespace sim::SIM_BACKEND
