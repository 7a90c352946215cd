#pragma once
/// Geometric multigrid for the low-frequency part of the pressure: -laplace q = C on the cells that contain
/// fluid, C = rho / rho_0 - 1 of a cell's water, q >= 0, q = 0 in the air and outside open faces, no flux
/// through walls and a lid.

#include <vector>

#include "libsim/particles/cells.hpp"

namespace sim::SIM_BACKEND {

enum class CellKind : std::uint8_t { Air, Fluid, Solid };

/// One grid in the form that kernels use. The equation of a fluid cell i for the pressure q: the sum of
/// conductance x (q_i - q_j), over those of its six neighbours j that are not solid, plus openness x
/// conductance x q_i for each open face, equals source_i.
struct GridView {
  CellBlock block, finest;
  Vec3 conductance;  ///< of a finest cell's faces across x, y, z; 1 for cubic cells
  int scale;         ///< edge of a cell, in finest cells
  CellKind* kind;
  float* q;  ///< 0 in cells without fluid
  float* source;
  float* diagonal;  ///< of a fluid cell's equation: the sum of its conductances
  const OpenFace* open;
  int open_count;
  CellKind top;  ///< kind of the cells above the block: Air, or Solid with a lid

  SIM_FN CellKind kind_at(int x, int y, int z) const {
    if (block.holds(x, y, z)) return kind[block.index(x, y, z)];
    return y >= block.ny ? top : CellKind::Solid;
  }
  /// Length, in finest cells, of the part of a cell inside the finest block: the last cell of a row may
  /// extend beyond it.
  SIM_FN float extent(int cell, int finest_cells) const {
    const int left = finest_cells - cell * scale;
    return static_cast<float>(left < scale ? left : scale);
  }
  /// Conductance of the face between the block and the cell (x, y, z) outside it, relative to that of an
  /// inner face. Outside an open face q = 0, at half a finest cell beyond the face, on every grid.
  SIM_FN float openness(int x, int y, int z) const {
    float share = 0;
    for (int o = 0; o < open_count; ++o) share += share_of(open[o], x, y, z);
    if (share <= 0) return 0;
    const auto way = static_cast<float>(scale);
    return quotient(way, 0.5f * (way - 1) + reciprocal(fminf(share, 1.0f)));
  }
  /// Share of the face between the block and the outside cell (x, y, z) that the opening `face` covers.
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
  /// Share of a cell's extent that the opening `face` covers along one of its two axes; `along`: 0 or 1.
  SIM_FN float covered(const OpenFace& face, int along, int cell, int cells, int finest_cells) const {
    if (cell < 0 || cell >= cells) return 0;
    const auto low = static_cast<float>(cell * scale);
    const float wide = extent(cell, finest_cells);
    const float both = fminf(face.high[along], low + wide) - fmaxf(face.low[along], low);
    return quotient(fmaxf(both, 0.0f), wide);
  }
  /// q of a cell; 0 in air, in walls and outside the block.
  SIM_FN float q_at(int x, int y, int z) const {
    return block.holds(x, y, z) ? q[block.index(x, y, z)] : 0.0f;
  }
};

class Multigrid {
 public:
  /// Allocates a finest grid of this many cells and its coarser grids; keeps them if the numbers of cells are
  /// unchanged. conductance: of a finest cell's faces across x, y and z, in proportion to a face's area
  /// divided by the distance between the two cells' centres. top: kind of the cells above the grid.
  void fit(CellBlock finest, Vec3 conductance = {1, 1, 1}, CellKind top = CellKind::Air);
  /// Opens these faces of the finest grid, and closes all others.
  void open(const std::vector<OpenFace>& faces) { open_.from_host(faces); }
  /// The finest grid. Write kind and source (C times the volume of each fluid cell, in the unit of
  /// conductances), then solve.
  GridView finest() { return view(0); }
  /// Runs V-cycles from q = 0.
  void solve(int cycles);

 private:
  /// One grid. One thread block solves the small grids together, from first_small() on. Of these only the
  /// finest has arrays; the coarser ones exist in scratch memory only.
  struct Level {
    CellBlock block;
    Array<CellKind> kind;
    Array<float> q, source, diagonal;
  };

  GridView view(std::size_t level);
  /// Index of the finest grid that one thread block solves together with all coarser grids.
  std::size_t first_small() const;

  void cycle(std::size_t level);
  /// V-cycles over the small grids, from q = 0.
  void cycle_small(int cycles);
  void smooth(std::size_t level, int first_colour);

  std::vector<Level> levels_;
  Array<OpenFace> open_;
  Array<unsigned char> room_;
  Vec3 conductance_{1, 1, 1};
  CellKind top_ = CellKind::Air;
};

}  // namespace sim::SIM_BACKEND
