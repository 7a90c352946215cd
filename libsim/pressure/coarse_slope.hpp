#pragma once
/// The gradient of the coarse pressure between its cells.

#include "libsim/pressure/coarse_grid.hpp"

namespace sim::SIM_BACKEND {

/// -grad q of the coarse pressure q, interpolated from the faces that touch fluid, like the velocity of a MAC
/// grid. At a position in front of an opening the outside counts as air, even if only a small part of the
/// cell's face is open.
struct CoarseSlope {
  PressureFrame frame;
  GridView grid;
  Walls walls;

  /// -grad q at the position x, m: the displacement by the coarse pressure, m.
  SIM_FN Vec3 down(Vec3 x) const {
    const Vec3 at = frame.in_cells(x);
    return {along<1, 0, 0>(at, x) / frame.edge.x, along<0, 1, 0>(at, x) / frame.edge.y,
            along<0, 0, 1>(at, x) / frame.edge.z};
  }

 private:
  /// The component along the axis (X, Y, Z), times the cell's edge, interpolated from the faces across this
  /// axis.
  template <int X, int Y, int Z>
  SIM_FN float along(Vec3 at, Vec3 metres) const {
    // Face (x, y, z) lies between cell (x, y, z) - (X, Y, Z) and cell (x, y, z).
    const Vec3 local = at - Vec3{X ? 0 : 0.5f, Y ? 0 : 0.5f, Z ? 0 : 0.5f};
    const Vec3 base{floorf(local.x), floorf(local.y), floorf(local.z)};
    const Vec3 part = local - base;
    float weights = 0;
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = static_cast<int>(base.x) + (corner & 1);
      const int y = static_cast<int>(base.y) + (corner >> 1 & 1);
      const int z = static_cast<int>(base.z) + (corner >> 2);
      const float weight = (corner & 1 ? part.x : 1 - part.x) * (corner & 2 ? part.y : 1 - part.y) *
                           (corner & 4 ? part.z : 1 - part.z);
      const CellKind here = grid.kind_at(x, y, z);
      const CellKind before = grid.kind_at(x - X, y - Y, z - Z);
      if (here != CellKind::Fluid && before != CellKind::Fluid) continue;
      weights += weight;
      if (here == CellKind::Solid || before == CellKind::Solid) {
        const bool low = before == CellKind::Solid;
        if (!walls.opening_count ||
            !opens<X, Y, Z>(low ? Place{x - X, y - Y, z - Z} : Place{x, y, z}, low, metres))
          continue;
      }
      sum += weight * (grid.q_at(x - X, y - Y, z - Z) - grid.q_at(x, y, z));
    }
    return weights > 0 ? sum / weights : 0;
  }

  struct Place {
    int x, y, z;
  };
  /// True if this solid cell is outside the block, beyond an opening in front of the particle.
  template <int X, int Y, int Z>
  SIM_FN bool opens(Place solid, bool low, Vec3 metres) const {
    if (grid.block.holds(solid.x, solid.y, solid.z)) return false;
    const float side = low ? 1.0f : -1.0f;
    for (int k = 0; k < walls.count; ++k) {
      if (dot(walls.planes[k].normal, Vec3{X, Y, Z}) == side && walls.opens(k, metres)) return true;
    }
    return false;
  }
};

}  // namespace sim::SIM_BACKEND
