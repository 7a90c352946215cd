#pragma once
/// The coupling between particles and the coarse pressure's cells.

#include "libsim/particles/solids.hpp"
#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

/// Sums over the particles of a cell: volume, and volume times (rho / rho_0 - 1). They are in fixed point, so
/// that they do not depend on the order of addition; the unit is CellWater::unit_volume /
/// CellWater::fixed_point.
struct CellSum {
  std::uint64_t volume, excess;
};

/// Position and size of the coarse pressure's cells. A whole number of cells fits between the walls, because
/// the equation assumes each wall at a face of a cell. In a cell cut by a wall, a thin layer of water would
/// weigh as much as a full cell.
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
  /// Floor area of a cell, m2: its volume V divided by its vertical edge. Both the cells' sources C V, with C
  /// = rho / rho_0 - 1, and the conductances of faces are divided by this edge.
  SIM_FN float floor_area() const { return edge.x * edge.z; }
  /// Conductance of the faces across x, y and z: area divided by distance and by the vertical edge.
  Vec3 conductance() const { return {edge.z / edge.x, floor_area() / (edge.y * edge.y), edge.x / edge.z}; }
};

/// The displacement of all particles by the coarse pressure, and the displacement that the push of walls and
/// obstacles alone would cause. Both are sums of mass in m_* (the mass of a particle of level 0) times
/// displacement in m.
struct PushBalance {
  MassWay pushed, walls;
  std::uint64_t mass;  ///< mass of the particles that were pushed, in m_*

  /// Displacement, m, to add to each pushed particle, so that `pushed` becomes equal to `walls`.
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

/// Calls visit(wall, inward normal, area in m2) for each face of a cell that lies on a wall. `wall` is the
/// index in Walls; the area excludes openings.
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
  face(5, x, y + 1, z, {0, -1, 0}, frame.floor_area());
}

/// Evaluates a cell's sums.
struct CellWater {
  PressureFrame frame;
  float unit_volume;  ///< volume unit of the sums, m3

  static constexpr float fixed_point = 1 << 20;
  /// A cell whose particles are on average below the rest density by more than this share contains a surface,
  /// and so the coarse pressure q is 0 in the cell. If only the sign of q decided, the set of surface cells
  /// would oscillate between cycles.
  static constexpr float surface_deficit = 0.05f;

  SIM_FN static float mean_excess(const CellSum& sum) {
    return static_cast<float>(static_cast<std::int64_t>(sum.excess)) / static_cast<float>(sum.volume);
  }
  SIM_FN static bool is_water(const CellSum& sum) {
    return sum.volume > 0 && mean_excess(sum) > -surface_deficit;
  }
  /// Share of the cell that particles of this volume, in the sums' fixed point, fill; at most 1.
  SIM_FN float filled(std::uint64_t volume) const {
    const float cell = frame.edge.x * frame.edge.y * frame.edge.z;
    return at_most(static_cast<float>(volume) / fixed_point * unit_volume / cell, 1.0f);
  }
};

/// Water level beside a body within a cell, as a share of the cell's height along Waterline::up: 0 = dry, 1 =
/// all water.
struct LevelBeside {
  float mean;  ///< mean over those of the four search directions in which a position outside bodies was found
  float most;  ///< maximum over these directions
};

/// Water level beside bodies, measured in the coarse pressure's cells. From a cell inside a body, beside()
/// searches perpendicular to `up`, in four directions, for the water outside the body.
struct Waterline {
  CellWater water;
  CellBlock block;
  Solids solids;
  const CellSum* sums;
  const std::uint64_t* volume;  ///< volume of all particles in each cell, including unsolved particles
  Vec3 up;                      ///< the axis nearest to the direction against gravity, with its sign

  SIM_FN LevelBeside beside(int x, int y, int z) const {
    const Vec3 at = middle_of(water.frame, x, y, z);
    int body;
    solids.nearest_body(at, body);
    const Vec3 from = at - solids.bodies[body].centre;
    const Vec3 level = from - dot(up, from) * up;
    const float away = length(level);
    const Vec3 out = away > 1e-6f ? Vec3{level.x / away, level.y / away, level.z / away} : side();
    const Vec3 across = cross(up, out);
    float sum = 0;
    float most = 0;
    int sides = 0;
    for (int side = 0; side < 4; ++side) {
      const Vec3 way = (side % 2 ? -1.0f : 1.0f) * (side < 2 ? out : across);
      const Vec3 place = outside(at, way);
      if (solids.nearest_body(place) < 0) continue;
      const float height = height_at(place);
      sum += height;
      most = at_least(most, height);
      ++sides;
    }
    return {sides > 0 ? sum / static_cast<float>(sides) : 0, most};
  }
  /// Steps from `from` in the direction `way` to the first position that is at least three quarters of a cell
  /// edge away from every body. If a wall comes first, the result is the last position found in front of the
  /// wall; if most_steps steps do not suffice, the position after them.
  SIM_FN Vec3 outside(Vec3 from, Vec3 way) const {
    const float clear = 0.75f * fabsf(dot(side(), water.frame.edge));
    Vec3 x = from;
    for (int step = 0; step < most_steps; ++step) {
      const float away = solids.nearest_body(x);
      if (away >= clear) break;
      const Vec3 next = x + at_least(clear - away, 0.25f * clear) * way;
      if (!solids.walls.holds(next)) return before_wall(x, next);
      x = next;
    }
    return x;
  }
  /// The farthest position inside the walls on the line from x to `beyond`, in steps of an eighth of the
  /// line.
  SIM_FN Vec3 before_wall(Vec3 x, Vec3 beyond) const {
    for (int part = 7; part > 0; --part) {
      const Vec3 place = x + (static_cast<float>(part) / 8) * (beyond - x);
      if (solids.walls.holds(place)) return place;
    }
    return x;
  }
  SIM_FN float height_at(Vec3 place) const {
    const Vec3 cells = water.frame.in_cells(place);
    const int x = static_cast<int>(floorf(cells.x));
    const int y = static_cast<int>(floorf(cells.y));
    const int z = static_cast<int>(floorf(cells.z));
    if (!block.holds(x, y, z)) return 0;
    const int ax = x + static_cast<int>(up.x);
    const int ay = y + static_cast<int>(up.y);
    const int az = z + static_cast<int>(up.z);
    if (block.holds(ax, ay, az) && CellWater::is_water(sums[block.index(ax, ay, az)])) return 1;
    return water.filled(volume[block.index(x, y, z)]);
  }

  /// Edge of a cell along `up`, m.
  SIM_FN float pitch() const { return fabsf(dot(up, water.frame.edge)); }

 private:
  /// An axis perpendicular to `up`.
  SIM_FN Vec3 side() const { return {up.y, up.z, up.x}; }
  static constexpr int most_steps = 16;
};

struct CoarseGrid {
  PressureFrame frame;
  Array<CellSum> sums;
  /// volume of all particles in each cell, in the unit of CellSum; only in scenes with obstacles
  Array<std::uint64_t> volume;
  Array<PushBalance> balance;
  Multigrid multigrid;

  /// Uses cells of `edge`, or wider if the domain would need more than `most_cells`; edges are then adjusted
  /// so that a whole number of cells fits between the walls. Without a lid the top is open, and the vertical
  /// edge is not adjusted.
  void fit(const Domain& domain, float edge, bool lid);
  /// Sets the walls' openings as open faces; call after fit. The walls must be those of the domain.
  void open(const Walls& walls);
  static constexpr double most_cells = 1 << 24;

 private:
  int opened_ = 0;      ///< number of openings last passed to the multigrid
  Vec3 opened_edge_{};  ///< edges of the cells at that time
};

}  // namespace sim::SIM_BACKEND
