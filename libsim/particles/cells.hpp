#pragma once
/// Regular cells over the tank, for sums over particles.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Cubic cells of one edge length from a low corner.
struct CellFrame {
  Vec3 low{};
  float edge = 1;
};

/// A box that contains the whole tank.
struct Domain {
  Vec3 low{}, high{};
};

/// An open part of a block's side, in cells of the finest grid: `axis` 0, 1, 2 = x, y, z, at its low or high
/// end, from low to high along the other two axes, ascending.
struct OpenFace {
  int axis;
  bool at_high;
  float low[2], high[2];
};

/// Cells of one grid, x fastest. Its sides and bottom are walls except for open faces; its top is air or a
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
