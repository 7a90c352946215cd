#pragma once
/// Regular cells over the tank, for sums over particles.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Position of a grid of cubic cells: its low corner and the cells' edge, m.
struct CellFrame {
  Vec3 low{};
  float edge = 1;
};

/// A box that contains the whole tank.
struct Domain {
  Vec3 low{}, high{};
};

/// An open rectangle in a side of a CellBlock. The side is perpendicular to `axis` (0, 1, 2 = x, y, z), at
/// the block's low or high end. The rectangle extends from `low` to `high` along the two remaining axes, the
/// lower axis first. The unit is a cell of the coarse pressure's finest multigrid level.
struct OpenFace {
  int axis;
  bool at_high;
  float low[2], high[2];
};

/// Numbers of cells of one grid; in indices x varies fastest. If the grid is one of the coarse pressure
/// (pressure/multigrid.hpp), its sides and bottom are walls except for open faces, and its top is air or a
/// lid.
struct CellBlock {
  int nx = 0, ny = 0, nz = 0;

  SIM_FN int size() const { return nx * ny * nz; }
  SIM_FN bool holds(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz;
  }
  SIM_FN int index(int x, int y, int z) const { return (z * ny + y) * nx + x; }
  SIM_FN CellBlock halved() const { return {(nx + 1) / 2, (ny + 1) / 2, (nz + 1) / 2}; }
};

}  // namespace sim::SIM_BACKEND
