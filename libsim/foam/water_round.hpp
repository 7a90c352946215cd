#pragma once
/// The water particles around a point, found in the grid of the last substep. Neighbour lists do not suffice:
/// at a frame's end not all particles have them, and diffuse particles have none.

#include "libsim/neighbors/grid.hpp"
#include "libsim/neighbors/neighbour_list.hpp"
#include "libsim/particles/kernels.hpp"

namespace sim::SIM_BACKEND {

struct WaterRound {
  CellTable cells;
  const Vec4* position;

  /// Calls visit(j, position of j) for all water particles closer than (h + h_j) / 2 to a particle of support
  /// h at x, and for some farther ones.
  template <class Visit>
  SIM_FN void with_pairs(Vec4 x, Visit& visit) const {
    for (int l = 0; l < cells.levels; ++l) in_level(x, cells.level[l], visit);
  }
  /// Calls visit(j, position of j) for all water particles closer to x than their own support h_j, and for
  /// some farther ones.
  template <class Visit>
  SIM_FN void that_reaches(Vec3 x, Visit& visit) const {
    for (int l = 0; l < cells.levels; ++l) in_level(with_w(x, cells.level[l].support), cells.level[l], visit);
  }

 private:
  template <class Visit>
  SIM_FN void in_level(Vec4 x, const LevelCells& grid, Visit& visit) const {
    if (cells.begin[grid.first] == cells.begin[grid.first + grid.size()]) return;
    const CellTable::Window look = cells.window(grid, x, NeighbourList::margin);
    for (int cy = look.first_y; cy <= look.last_y; ++cy) {
      for (int cz = look.first_z; cz <= look.last_z; ++cz) {
        const IndexRange run = cells.line(grid, look, cy, cz);
        for (int j = run.begin; j < run.end; ++j) visit(j, position[j]);
      }
    }
  }
};

}  // namespace sim::SIM_BACKEND
