#pragma once
/// Water level beside bodies, from the coarse pressure's cells.

#include "libsim/pressure/coarse_grid.hpp"

namespace sim::SIM_BACKEND {

/// Evaluates a cell's sums.
struct CellWater {
  PressureFrame frame;
  float unit_volume;  ///< volume unit of the sums, m3

  static constexpr float fixed_point = 1 << 20;
  /// A cell whose particles are on average below the rest density by more than this share contains a surface:
  /// q = 0 there. If only the sign of q decided, the set of such cells would oscillate between cycles.
  static constexpr float surface_deficit = 0.05f;

  SIM_FN static float mean_excess(const CellSum& sum) {
    return static_cast<float>(static_cast<std::int64_t>(sum.excess)) / static_cast<float>(sum.volume);
  }
  SIM_FN static bool is_water(const CellSum& sum) {
    return sum.volume > 0 && mean_excess(sum) > -surface_deficit;
  }
  /// Share of the cell filled by particles of this volume.
  SIM_FN float filled(std::uint64_t volume) const {
    const float cell = frame.edge.x * frame.edge.y * frame.edge.z;
    return at_most(static_cast<float>(volume) / fixed_point * unit_volume / cell, 1.0f);
  }
};

/// Height of the water beside a body within a cell: 0 dry, 1 below the surface.
struct LevelBeside {
  float mean;  ///< over the sides that have a value
  float most;
};

/// Searches horizontally from a cell inside bodies to the water outside, on four sides.
struct Waterline {
  CellWater water;
  CellBlock block;
  Solids solids;
  const CellSum* sums;
  const std::uint64_t* volume;  ///< of all particles, including resting ones

  SIM_FN LevelBeside beside(int x, int y, int z) const {
    const Vec3 at = middle_of(water.frame, x, y, z);
    int body;
    solids.nearest_body(at, body);
    const Vec3 from = at - solids.bodies[body].centre;
    const float away = sqrtf(from.x * from.x + from.z * from.z);
    const Vec3 out = away > 1e-6f ? Vec3{from.x / away, 0, from.z / away} : Vec3{1, 0, 0};
    float sum = 0;
    float most = 0;
    int sides = 0;
    for (int side = 0; side < 4; ++side) {
      const Vec3 way = side == 0   ? out
                       : side == 1 ? -1.0f * out
                       : side == 2 ? Vec3{out.z, 0, -out.x}
                                   : Vec3{-out.z, 0, out.x};
      const Vec3 place = outside(at, way);
      if (solids.nearest_body(place) < 0) continue;
      const float height = height_at(place);
      sum += height;
      most = at_least(most, height);
      ++sides;
    }
    return {sides > 0 ? sum / static_cast<float>(sides) : 0, most};
  }
  /// The first position along `way` whose cell is usually free of bodies; if the gap is narrower, the last
  /// one before a wall.
  SIM_FN Vec3 outside(Vec3 from, Vec3 way) const {
    const float clear = 0.75f * water.frame.edge.x;
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
  /// The farthest position from x towards `beyond` inside the walls, to an eighth.
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
    if (block.holds(x, y + 1, z) && CellWater::is_water(sums[block.index(x, y + 1, z)])) return 1;
    return water.filled(volume[block.index(x, y, z)]);
  }

 private:
  static constexpr int most_steps = 16;
};

}  // namespace sim::SIM_BACKEND
