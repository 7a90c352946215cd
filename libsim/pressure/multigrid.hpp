#pragma once
/// Geometric multigrid for the slow part of the pressure: -laplace q = C on the cells that hold fluid, q >=
/// 0, q = 0 in the air, no flux through walls.

#include <array>
#include <vector>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// What a cell of the finest grid holds.
enum class CellKind : std::uint8_t { Air, Fluid, Solid };

/// Cells of one grid, x fastest.
struct CellBlock {
  int nx = 0, ny = 0, nz = 0;

  SIM_FN int size() const { return nx * ny * nz; }
  SIM_FN bool holds(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz;
  }
  SIM_FN int index(int x, int y, int z) const { return (z * ny + y) * nx + x; }
  SIM_FN CellBlock halved() const { return {(nx + 1) / 2, (ny + 1) / 2, (nz + 1) / 2}; }
};

/// Conductances of a cell: to its neighbours at +x, +y, +z, and the sum over all six faces, air included.
/// All zero where there is no fluid.
struct alignas(16) Links {
  float x, y, z, sum;
};

/// One grid as kernels see it. The equation of cell i is sum_i q_i - sum_j link_ij q_j = source_i.
struct LevelView {
  CellBlock block;
  const Links* links;
  float* q;
  float* source;
};

class Multigrid {
 public:
  /// Makes room for a finest grid of this many cells and its coarser ones. Cheap when nothing changed.
  void fit(CellBlock finest);
  const CellBlock& block() const { return levels_.front().block; }
  /// Input of solve(), one value a cell: what it holds, and edge^2 C.
  Array<CellKind>& kind() { return kind_; }
  Array<float>& source() { return levels_.front().source; }
  /// Runs V-cycles from q = 0.
  void solve(int cycles);
  const Array<float>& q() const { return levels_.front().q; }

 private:
  struct Level {
    CellBlock block;
    Array<Links> links;
    Array<float> q, source;
    LevelView view() { return {block, links.data(), q.data(), source.data()}; }
  };

  void link();
  void cycle(std::size_t level);
  void smooth(std::size_t level, std::array<int, 2> colours);

  std::vector<Level> levels_;
  Array<CellKind> kind_;
};

}  // namespace sim::SIM_BACKEND
