#pragma once
/// Cells over the tank in which particles look for neighbours: one grid for each mass level, all in one table
/// that says where each cell's particles begin. The outermost cells of a grid hold everything beyond them, so
/// that a place far outside costs no memory and loses no pair.

#include "libsim/particles/cells.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// The grid of one level. Lines of cells along x lie one after another, then along z, then along y.
struct LevelCells {
  float support;  ///< h of its particles, m
  float edge, inverse;
  int nx, ny, nz;
  int first;  ///< of its cells in the table

  SIM_FN int size() const { return nx * ny * nz; }
  /// The cell along one axis of a place `x` from the low corner: 1 .. count - 2 inside the domain.
  SIM_FN int along(float x, int count) const {
    const float cell = floorf(x * inverse) + 1;
    return static_cast<int>(at_most(at_least(cell, 0.0f), static_cast<float>(count - 1)));
  }
  /// How far x lies outside the slab of a cell along one axis.
  SIM_FN float gap(float x, int cell, int count) const {
    const float low = static_cast<float>(cell - 1) * edge - x;
    const float below = cell > 0 ? low : 0.0f;
    const float above = cell < count - 1 ? -(low + edge) : 0.0f;
    return at_least(at_least(below, above), 0.0f);
  }
};

/// As kernels see it.
struct CellTable {
  LevelCells level[LevelSupports::most];
  int levels;        ///< in use
  Vec3 low;          ///< corner of the domain
  const int* begin;  ///< of each cell's particles, and after the last cell the number of particles

  SIM_FN int cell(int l, Vec4 p) const {
    const LevelCells& grid = level[l];
    const int y = grid.along(p.y - low.y, grid.ny);
    const int z = grid.along(p.z - low.z, grid.nz);
    return grid.first + (y * grid.nz + z) * grid.nx + grid.along(p.x - low.x, grid.nx);
  }

  /// visit(begin, end) of runs of particles, in ascending order, that hold all within margin x (h + h_other)
  /// / 2 of a particle, and itself.
  template <class Visit>
  SIM_FN void around(Vec4 self, float margin, Visit visit) const {
    const Vec3 at = xyz(self) - low;
    for (int l = 0; l < levels; ++l) {
      const LevelCells& grid = level[l];
      if (begin[grid.first] == begin[grid.first + grid.size()]) continue;
      // Beyond what rounding of places, distances and cells can hide.
      const float reach = 1.0001f * (0.5f * margin * (self.w + grid.support)) +
                          1e-6f * (fabsf(at.x) + fabsf(at.y) + fabsf(at.z));
      const int last_y = grid.along(at.y + reach, grid.ny);
      const int first_z = grid.along(at.z - reach, grid.nz);
      const int last_z = grid.along(at.z + reach, grid.nz);
      for (int y = grid.along(at.y - reach, grid.ny); y <= last_y; ++y) {
        const float dy = grid.gap(at.y, y, grid.ny);
        for (int z = first_z; z <= last_z; ++z) {
          const float dz = grid.gap(at.z, z, grid.nz);
          const float left = reach * reach - dy * dy - dz * dz;
          if (!(left > 0)) continue;
          const float half = rough_root(left);
          const int line = grid.first + (y * grid.nz + z) * grid.nx;
          const int from = begin[line + grid.along(at.x - half, grid.nx)];
          const int to = begin[line + grid.along(at.x + half, grid.nx) + 1];
          if (from < to) visit(from, to);
        }
      }
    }
  }
};

}  // namespace sim::SIM_BACKEND
