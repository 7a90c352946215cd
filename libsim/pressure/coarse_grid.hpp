#pragma once
/// The coupling between particles and the coarse pressure's cells.

#include "libsim/particles/solids.hpp"
#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

/// Sums over the particles of a cell, in fixed point, so that they do not depend on the order of addition.
struct CellSum {
  std::uint64_t volume, excess;
};

/// The coarse pressure's cells. A whole number fits between the walls: in the equation a wall is at its
/// cell's end, and a thin layer of water in a cell cut by a wall would weigh as much as a full cell.
struct PressureFrame {
  Vec3 low{};
  Vec3 edge{1, 1, 1};

  /// A position in cell units.
  SIM_FN Vec3 in_cells(Vec3 x) const {
    const Vec3 from = x - low;
    return {from.x / edge.x, from.y / edge.y, from.z / edge.z};
  }
  SIM_FN Vec3 in_metres(Vec3 cells) const {
    return low + Vec3{edge.x * cells.x, edge.y * cells.y, edge.z * cells.z};
  }
  /// Volume divided by the vertical edge, the unit of the sources C V and the conductances of faces.
  SIM_FN float floor_area() const { return edge.x * edge.z; }
  /// Area divided by distance for the faces across x, y and z.
  Vec3 conductance() const { return {edge.z / edge.x, floor_area() / (edge.y * edge.y), edge.x / edge.z}; }
};

/// What the coarse pressure did to the water in total, and the walls' share of it: mass in m_* times
/// displacement.
struct PushBalance {
  MassWay pushed, walls;
  std::uint64_t mass;  ///< of the particles that were pushed, in m_*

  /// Displacement of each pushed particle that makes the two equal.
  SIM_FN Vec3 correction() const {
    if (mass == 0) return {0, 0, 0};
    return (1 / static_cast<float>(mass)) * (walls - pushed).value();
  }
};

/// The centre of a cell, m.
SIM_FN Vec3 middle_of(const PressureFrame& frame, int x, int y, int z) {
  const auto middle = [](int cell) { return static_cast<float>(cell) + 0.5f; };
  return frame.in_metres({middle(x), middle(y), middle(z)});
}
/// True if a solid cell belongs to an obstacle and not to a wall.
SIM_FN bool body_has(const Walls&, const PressureFrame&, const GridView&, int, int, int) { return false; }
SIM_FN bool body_has(const Solids& solids, const PressureFrame& frame, const GridView& grid, int x, int y,
                     int z) {
  return grid.block.holds(x, y, z) && solids.walls.holds(middle_of(frame, x, y, z));
}

/// Calls hear(wall, inward normal, area in m2) with the closed area of each face of a cell that lies on a
/// wall, in the order of Walls.
template <class Boundary, class Visit>
SIM_FN void for_wall_faces(const PressureFrame& frame, const GridView& grid, const Boundary& boundary,
                           int cell, Visit visit) {
  const CellBlock& block = grid.block;
  const int x = cell % block.nx;
  const int y = cell / block.nx % block.ny;
  const int z = cell / (block.nx * block.ny);
  const float across_x = frame.edge.y * frame.edge.z;
  const float across_z = frame.edge.x * frame.edge.y;
  const auto face = [&](int wall, int nx, int ny, int nz, Vec3 normal, float area) {
    if (grid.kind_at(nx, ny, nz) != CellKind::Solid || body_has(boundary, frame, grid, nx, ny, nz)) return;
    const float shut = grid.open_count > 0 ? 1 - grid.openness(nx, ny, nz) : 1.0f;
    visit(wall, normal, shut * area);
  };
  face(0, x - 1, y, z, {1, 0, 0}, across_x);
  face(1, x + 1, y, z, {-1, 0, 0}, across_x);
  face(2, x, y, z - 1, {0, 0, 1}, across_z);
  face(3, x, y, z + 1, {0, 0, -1}, across_z);
  face(4, x, y - 1, z, {0, 1, 0}, frame.floor_area());
}

struct CoarseGrid {
  PressureFrame frame;
  Array<CellSum> sums;
  Array<std::uint64_t> volume;  ///< of all particles in a cell, as in CellSum; only with obstacles
  Array<PushBalance> balance;
  Multigrid multigrid;

  /// Uses cells of `edge`, or wider if the domain would need more than `most_cells`; horizontal edges are
  /// then adjusted so that a whole number of cells fits between the walls.
  void fit(const Domain& domain, float edge);
  /// Sets the walls' openings as open faces; call after fit. The walls must be those of the domain.
  void open(const Walls& walls);
  static constexpr double most_cells = 1 << 24;

 private:
  int opened_ = 0;      ///< number of openings passed to the multigrid
  Vec3 opened_edge_{};  ///< cell edge at that time
};

}  // namespace sim::SIM_BACKEND
