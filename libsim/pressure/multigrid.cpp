#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Place {
  int x, y, z;
};
SIM_FN Place place_of(const CellBlock& block, int i) {
  return {i % block.nx, i / block.nx % block.ny, i / (block.nx * block.ny)};
}

/// A coarser cell is fluid when no child is air: its surface then lies within half a cell of the true one, on
/// either side. Counting cells with any fluid as fluid lets a grid overshoot until the cycles diverge.
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

/// A cell's equation without its own q: the sum of conductances and of conductance x q. Conductance = area
/// over way, in finest cells, times theirs.
struct Around {
  float weights = 0;
  float sum = 0;

  SIM_FN void add(const GridView& grid, float weight, int x, int y, int z) {
    if (grid.kind_at(x, y, z) != CellKind::Solid) {
      weights += weight;
    } else if (grid.open_count > 0) {
      weights += weight * grid.openness(x, y, z);
    }
    sum += weight * grid.q_at(x, y, z);
  }
  SIM_FN Around(const GridView& grid, Place p) {
    const float x = grid.extent(p.x, grid.finest.nx);
    const float y = grid.extent(p.y, grid.finest.ny);
    const float z = grid.extent(p.z, grid.finest.nz);
    const Vec3 over = (1 / static_cast<float>(grid.scale)) * grid.conductance;
    add(grid, y * z * over.x, p.x - 1, p.y, p.z);
    add(grid, y * z * over.x, p.x + 1, p.y, p.z);
    add(grid, x * z * over.y, p.x, p.y - 1, p.z);
    add(grid, x * z * over.y, p.x, p.y + 1, p.z);
    add(grid, x * y * over.z, p.x, p.y, p.z - 1);
    add(grid, x * y * over.z, p.x, p.y, p.z + 1);
  }
};

/// Gauss-Seidel on the cells of one colour; on the finest grid the pressure stays a push.
struct Smooth {
  GridView grid;
  int colour;
  bool push_only;
  SIM_FN void operator()(int i) const {
    const Place p = place_of(grid.block, i);
    if (((p.x + p.y + p.z) & 1) != colour || grid.kind[i] != CellKind::Fluid) return;
    const Around around(grid, p);
    if (around.weights <= 0) return;
    const float q = (grid.source[i] + around.sum) / around.weights;
    grid.q[i] = push_only ? at_least(q, 0.0f) : q;
  }
};

/// Source of the coarser grid: the sum of the finer residuals. Where a cell rests at q = 0 and wants to pull,
/// nothing is left to solve.
struct Restrict {
  GridView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const {
    const Place p = place_of(coarse.block, i);
    float sum = 0;
    for (int child = 0; child < 8; ++child) {
      const Place c{2 * p.x + (child & 1), 2 * p.y + (child >> 1 & 1), 2 * p.z + (child >> 2)};
      if (fine.kind_at(c.x, c.y, c.z) != CellKind::Fluid) continue;
      const int at = fine.block.index(c.x, c.y, c.z);
      const Around around(fine, c);
      const float residual = fine.source[at] + around.sum - around.weights * fine.q[at];
      if (push_only && fine.q[at] <= 0 && residual < 0) continue;
      sum += residual;
    }
    coarse.source[i] = sum;
    coarse.q[i] = 0;
  }
};

/// Adds the coarser grid's correction, trilinear between cell centres, mirrored at walls and sloping to zero
/// outside open faces.
struct Prolong {
  GridView fine, coarse;
  bool push_only;
  SIM_FN void operator()(int i) const {
    if (fine.kind[i] != CellKind::Fluid) return;
    const Place p = place_of(fine.block, i);
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

/// The coarsest grid has at most this many cells along its longest side.
constexpr int coarsest_side = 2;
constexpr int coarsest_sweeps = 4;

}  // namespace

/// The grids from `first` down to the coarsest, small enough for one block: their part of a V-cycle.
struct SmallGrids {
  static constexpr int most = 16;
  GridView grid[most];
  int count;

  SIM_FN bool push_only(int level) const { return grid[level].scale == 1; }

  template <class Block>
  SIM_FN void smooth(Block block, int level, int first_colour) const {
    const GridView& at = grid[level];
    for (int half = 0; half < 2; ++half) {
      block.each(at.block.size(), Smooth{at, half == 0 ? first_colour : 1 - first_colour, push_only(level)});
    }
  }
  template <class Block>
  SIM_FN void operator()(Block block) const {
    const int last = count - 1;
    for (int level = 0; level < last; ++level) {
      smooth(block, level, 0);
      block.each(grid[level + 1].block.size(), Restrict{grid[level], grid[level + 1], push_only(level)});
    }
    for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) smooth(block, last, 0);
    for (int level = last - 1; level >= 0; --level) {
      block.each(grid[level].block.size(), Prolong{grid[level], grid[level + 1], push_only(level)});
      smooth(block, level, 1);
    }
  }
};

namespace {

/// Kinds of the small grids below the first, each from the one before.
struct CoarsenSmall {
  SmallGrids grids;
  template <class Block>
  SIM_FN void operator()(Block block) const {
    for (int level = 1; level < grids.count; ++level) {
      block.each(grids.grid[level].block.size(), Coarsen{grids.grid[level - 1], grids.grid[level]});
    }
  }
};

}  // namespace

void Multigrid::fit(CellBlock finest, Vec3 conductance) {
  conductance_ = conductance;
  if (!levels_.empty()) {
    const CellBlock now = levels_.front().block;
    if (finest.nx == now.nx && finest.ny == now.ny && finest.nz == now.nz) return;
  }
  levels_.clear();
  for (CellBlock block = finest;; block = block.halved()) {
    Level level;
    level.block = block;
    const auto size = static_cast<std::size_t>(block.size());
    level.kind.resize(size);
    level.q.resize(size);
    level.source.resize(size);
    levels_.push_back(std::move(level));
    if (block.nx <= coarsest_side && block.ny <= coarsest_side && block.nz <= coarsest_side) break;
  }
}

GridView Multigrid::view(std::size_t level) {
  auto& at = levels_[level];
  return {at.block,         levels_.front().block, conductance_,
          1 << level,       at.kind.data(),        at.q.data(),
          at.source.data(), open_.data(),          static_cast<int>(open_.size())};
}

void Multigrid::smooth(std::size_t level, int first_colour) {
  const GridView at = view(level);
  for (const int colour : {first_colour, 1 - first_colour}) {
    for_each("smooth", at.block.size(), Smooth{at, colour, level == 0});
  }
}

std::size_t Multigrid::first_small() const {
  std::size_t level = levels_.size() - 1;
  while (level > 0 && levels_.size() - level < SmallGrids::most &&
         levels_[level - 1].block.size() <= one_block_cells)
    --level;
  return level;
}

SmallGrids Multigrid::small_grids() {
  const std::size_t small = first_small();
  SmallGrids out{{}, static_cast<int>(levels_.size() - small)};
  for (std::size_t l = small; l < levels_.size(); ++l) out.grid[l - small] = view(l);
  return out;
}

void Multigrid::cycle(std::size_t level) {
  if (level == first_small()) {
    in_one_block("small grids", small_grids());
    return;
  }
  const GridView fine = view(level);
  const GridView coarse = view(level + 1);
  smooth(level, 0);
  for_each("restrict", coarse.block.size(), Restrict{fine, coarse, level == 0});
  cycle(level + 1);
  for_each("prolong", fine.block.size(), Prolong{fine, coarse, level == 0});
  smooth(level, 1);
}

void Multigrid::solve(int cycles) {
  const std::size_t small = first_small();
  for (std::size_t l = 1; l <= small; ++l) {
    for_each("coarsen", levels_[l].block.size(), Coarsen{view(l - 1), view(l)});
  }
  in_one_block("coarsen small grids", CoarsenSmall{small_grids()});
  levels_.front().q.zero();
  for (int c = 0; c < cycles; ++c) cycle(0);
}

}  // namespace sim::SIM_BACKEND
