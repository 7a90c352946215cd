#pragma once
/// The passes of a V-cycle, one functor each. operator()(index) processes one cell. Functors with a function
/// cell(place, index) also process one cell whose position is already known.

#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

struct Place {
  int x, y, z;
};
SIM_FN Place place_of(const CellBlock& block, int i) {
  const int row = i / block.nx;
  const int z = row / block.ny;
  return {i - row * block.nx, row - z * block.ny, z};
}

/// Sets the kind of a coarser cell from its eight children: air if one is air, otherwise fluid if one is
/// fluid, otherwise solid. The coarser grid's water surface is then at most half a cell from the true
/// surface. If every cell with some fluid counted as fluid, the corrections would overshoot and the cycles
/// diverge.
struct Coarsen {
  GridView fine, coarse;
  SIM_FN void operator()(int i) const {
    const Place p = place_of(coarse.block, i);
    bool air = false;
    bool fluid = false;
    for (int child = 0; child < 8; ++child) {
      const CellKind kind =
          fine.kind_at(2 * p.x + (child & 1), 2 * p.y + (child >> 1 & 1), 2 * p.z + (child >> 2));
      air = air || kind == CellKind::Air;
      fluid = fluid || kind == CellKind::Fluid;
    }
    coarse.kind[i] = air ? CellKind::Air : fluid ? CellKind::Fluid : CellKind::Solid;
  }
};

/// Conductances of a cell's faces across x, y, z: area over distance, both measured in finest cells, times
/// the conductances of a finest cell.
SIM_FN Vec3 conductances(const GridView& grid, Place p) {
  if (grid.scale == 1) return grid.conductance;
  const float x = grid.extent(p.x, grid.finest.nx);
  const float y = grid.extent(p.y, grid.finest.ny);
  const float z = grid.extent(p.z, grid.finest.nz);
  const Vec3 over = reciprocal(static_cast<float>(grid.scale)) * grid.conductance;
  return {y * z * over.x, x * z * over.y, x * y * over.z};
}

/// Computes the diagonal of each fluid cell's equation once; all sweeps of a solve use it.
struct Weigh {
  GridView grid;
  SIM_FN void operator()(int i) const {
    if (grid.kind[i] == CellKind::Fluid) {
      cell(place_of(grid.block, i), i);
    } else {
      grid.diagonal[i] = 0;
    }
  }
  SIM_FN void cell(Place p, int i) const {
    float sum = 0;
    const Vec3 over = conductances(grid, p);
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      const int step = face % 2 ? 1 : -1;
      const float weight = axis == 0 ? over.x : axis == 1 ? over.y : over.z;
      sum += weight * opening(p.x + (axis == 0 ? step : 0), p.y + (axis == 1 ? step : 0),
                              p.z + (axis == 2 ? step : 0));
    }
    grid.diagonal[i] = sum;
  }
  /// Relative conductance of the face towards the neighbour cell at this position: 1 towards fluid or air, 0
  /// towards a closed wall, GridView::openness towards an opening.
  SIM_FN float opening(int x, int y, int z) const {
    if (grid.kind_at(x, y, z) != CellKind::Solid) return 1;
    return grid.open_count > 0 ? grid.openness(x, y, z) : 0;
  }
};

/// The sum of conductance times q over the six neighbours of cell i at position p.
SIM_FN float around(const GridView& grid, Place p, int i) {
  const CellBlock& block = grid.block;
  const Vec3 over = conductances(grid, p);
  const int row = block.nx;
  const int layer = block.nx * block.ny;
  float sum = 0;
  sum += over.x * (p.x > 0 ? grid.q[i - 1] : 0);
  sum += over.x * (p.x + 1 < block.nx ? grid.q[i + 1] : 0);
  sum += over.y * (p.y > 0 ? grid.q[i - row] : 0);
  sum += over.y * (p.y + 1 < block.ny ? grid.q[i + row] : 0);
  sum += over.z * (p.z > 0 ? grid.q[i - layer] : 0);
  sum += over.z * (p.z + 1 < block.nz ? grid.q[i + layer] : 0);
  return sum;
}

/// A Gauss-Seidel sweep over the cells of one colour of a checkerboard. push_only keeps the pressure q >= 0;
/// it is set on the finest grid. The index counts pairs of adjacent cells in a row, of which one has the
/// colour.
struct Smooth {
  GridView grid;
  int colour;
  bool push_only;

  SIM_FN static int size(const CellBlock& block) { return (block.nx + 1) / 2 * block.ny * block.nz; }
  SIM_FN void operator()(int half) const {
    const Place pair = place_of({(grid.block.nx + 1) / 2, grid.block.ny, grid.block.nz}, half);
    const Place p{2 * pair.x + ((pair.y + pair.z + colour) & 1), pair.y, pair.z};
    if (p.x < grid.block.nx) cell(p, grid.block.index(p.x, p.y, p.z));
  }
  SIM_FN void cell(Place p, int i) const {
    const float diagonal = grid.diagonal[i];
    if (diagonal <= 0) return;
    const float q = (grid.source[i] + around(grid, p, i)) / diagonal;
    grid.q[i] = push_only ? at_least(q, 0.0f) : q;
  }
};

/// Computes the source of a coarser cell: the sum of the residuals of its fluid children. With push_only, a
/// child at the bound q = 0 of the pressure, with a negative residual, contributes nothing.
struct Restrict {
  GridView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const { cell(place_of(coarse.block, i), i); }
  SIM_FN void cell(Place p, int i) const {
    float sum = 0;
    for (int child = 0; child < 8; ++child) {
      const Place c{2 * p.x + (child & 1), 2 * p.y + (child >> 1 & 1), 2 * p.z + (child >> 2)};
      if (fine.kind_at(c.x, c.y, c.z) != CellKind::Fluid) continue;
      const int at = fine.block.index(c.x, c.y, c.z);
      const float residual = fine.source[at] + around(fine, c, at) - fine.diagonal[at] * fine.q[at];
      if (push_only && fine.q[at] <= 0 && residual < 0) continue;
      sum += residual;
    }
    coarse.source[i] = sum;
    coarse.q[i] = 0;
  }
};

/// Adds the coarser grid's correction to the finer q. The correction is interpolated trilinearly between cell
/// centres, mirrored at walls, and 0 outside open faces.
struct Prolong {
  GridView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const {
    if (fine.kind[i] == CellKind::Fluid) cell(place_of(fine.block, i), i);
  }
  SIM_FN void cell(Place p, int i) const {
    const Place parent{p.x / 2, p.y / 2, p.z / 2};
    const Place beside{parent.x + (p.x & 1 ? 1 : -1), parent.y + (p.y & 1 ? 1 : -1),
                       parent.z + (p.z & 1 ? 1 : -1)};
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Place c{corner & 1 ? beside.x : parent.x, corner & 2 ? beside.y : parent.y,
                    corner & 4 ? beside.z : parent.z};
      const float weight =
          (corner & 1 ? 0.25f : 0.75f) * (corner & 2 ? 0.25f : 0.75f) * (corner & 4 ? 0.25f : 0.75f);
      const bool solid = coarse.kind_at(c.x, c.y, c.z) == CellKind::Solid;
      const float shut = solid && coarse.open_count > 0 ? 1 - coarse.openness(c.x, c.y, c.z) : 1.0f;
      sum += weight * (solid ? shut * coarse.q_at(parent.x, parent.y, parent.z) : coarse.q_at(c.x, c.y, c.z));
    }
    const float q = fine.q[i] + sum;
    fine.q[i] = push_only ? at_least(q, 0.0f) : q;
  }
};

}  // namespace sim::SIM_BACKEND
