#pragma once
/// The bridge between particles and the coarse pressure's cells.

#include "libsim/particles/solids.hpp"
#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

/// What particles bring to a cell, in fixed point, so that the sum does not depend on the order of adding.
struct CellSum {
  std::uint64_t volume, excess;
};

/// The coarse pressure's cells. They fit whole between the walls: for the equation a wall stands where its
/// cell ends, and the little water before a wall that cuts a cell would weigh as much as a full cell.
struct PressureFrame {
  Vec3 low{};
  Vec3 edge{1, 1, 1};

  /// A place in cells.
  SIM_FN Vec3 in_cells(Vec3 x) const {
    const Vec3 from = x - low;
    return {from.x / edge.x, from.y / edge.y, from.z / edge.z};
  }
  SIM_FN Vec3 in_metres(Vec3 cells) const {
    return low + Vec3{edge.x * cells.x, edge.y * cells.y, edge.z * cells.z};
  }
  /// Volume over upright edge, the unit in which sources C V and the conductances of faces are given.
  SIM_FN float floor_area() const { return edge.x * edge.z; }
  /// Area over way of the faces across x, y and z.
  Vec3 conductance() const { return {edge.z / edge.x, floor_area() / (edge.y * edge.y), edge.x / edge.z}; }
};

/// What the coarse pressure did to the water as a whole, and what the walls gave of it: ways over m_*.
struct PushBalance {
  MassWay pushed, walls;
  std::uint64_t mass;  ///< of the particles that were pushed, in m_*

  /// Way of each pushed particle that makes the two equal.
  SIM_FN Vec3 correction() const {
    if (mass == 0) return {0, 0, 0};
    return (1 / static_cast<float>(mass)) * (walls - pushed).value();
  }
};

/// How much of a face between a cell and a solid place is a wall's and no obstacle's.
SIM_FN float wall_share(const GridView&, int, int, int, int, int) { return 1; }
SIM_FN float wall_share(const CutView& grid, int cell, int wall, int x, int y, int z) {
  if (grid.block.holds(x, y, z)) return grid.open_volume[grid.block.index(x, y, z)] < 1 ? 0.0f : 1.0f;
  return wall == 0   ? low_share(grid, cell, 0)
         : wall == 2 ? low_share(grid, cell, 2)
         : wall == 4 ? low_share(grid, cell, 1)
                     : 1.0f;
}

/// Gives hear(wall, inward normal, area in m2) what is shut of each face of a cell that lies on a wall, in
/// the order of Walls.
template <class Grid, class Hear>
SIM_FN void for_wall_faces(const PressureFrame& frame, const Grid& grid, int cell, Hear hear) {
  const CellBlock& block = grid.block;
  const int x = cell % block.nx;
  const int y = cell / block.nx % block.ny;
  const int z = cell / (block.nx * block.ny);
  const float across_x = frame.edge.y * frame.edge.z;
  const float across_z = frame.edge.x * frame.edge.y;
  const auto face = [&](int wall, int nx, int ny, int nz, Vec3 normal, float area) {
    if (grid.kind_at(nx, ny, nz) != CellKind::Solid) return;
    const float shut = grid.open_count > 0 ? 1 - grid.openness(nx, ny, nz) : 1.0f;
    hear(wall, normal, wall_share(grid, cell, wall, nx, ny, nz) * shut * area);
  };
  face(0, x - 1, y, z, {1, 0, 0}, across_x);
  face(1, x + 1, y, z, {-1, 0, 0}, across_x);
  face(2, x, y, z - 1, {0, 0, 1}, across_z);
  face(3, x, y, z + 1, {0, 0, -1}, across_z);
  face(4, x, y - 1, z, {0, 1, 0}, frame.floor_area());
}

/// What obstacles shut of a cell's faces, as the sum of area times the normal into the cell, m2. Over all
/// cells with a pressure of one gradient it is the obstacle's volume times that.
SIM_FN Vec3 shut_by_bodies(const PressureFrame& frame, const CutView& grid, int cell) {
  const CellBlock& block = grid.block;
  const int x = cell % block.nx;
  const int y = cell / block.nx % block.ny;
  const int z = cell / (block.nx * block.ny);
  const auto shut = [&](int axis, int nx, int ny, int nz, int owner) {
    if (!block.holds(nx, ny, nz)) return owner == cell ? 1 - low_share(grid, cell, axis) : 0.0f;
    const int beside = block.index(nx, ny, nz);
    if (grid.kind[beside] == CellKind::Solid) return grid.open_volume[beside] < 1 ? 1.0f : 0.0f;
    return 1 - low_share(grid, owner, axis);
  };
  const Vec3 e = frame.edge;
  const int row = block.nx;
  const int layer = block.nx * block.ny;
  return {e.y * e.z * (shut(0, x - 1, y, z, cell) - shut(0, x + 1, y, z, cell + 1)),
          e.x * e.z * (shut(1, x, y - 1, z, cell) - shut(1, x, y + 1, z, cell + row)),
          e.x * e.y * (shut(2, x, y, z - 1, cell) - shut(2, x, y, z + 1, cell + layer))};
}

struct CoarseGrid {
  PressureFrame frame;
  Array<CellSum> sums;
  Array<PushBalance> balance;
  Array<float> open_volume;  ///< share of each cell that obstacles leave; only with obstacles
  Multigrid multigrid;

  /// Cells of `edge`, or wider where the domain would need more than `most_cells`; across they are as much
  /// wider or narrower as makes whole ones fit between the walls.
  void fit(const Domain& domain, float edge);
  /// The walls' openings as open faces; after fit. Walls are those of the domain.
  void open(const Walls& walls);
  static constexpr double most_cells = 1 << 24;
  /// The finest grid with what the bodies shut of its cells and faces; after fit.
  CutView cut(const Solids& solids);

 private:
  int opened_ = 0;      ///< openings that the multigrid has
  Vec3 opened_edge_{};  ///< with cells of this edge
};

}  // namespace sim::SIM_BACKEND
