#include "libsim/pressure/multigrid.hpp"

#include "libsim/exec/one_block.hpp"
#include "libsim/pressure/grid_passes.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// The coarsest grid has at most this many cells along its longest side.
constexpr int coarsest_side = 2;

/// Number of Gauss-Seidel sweeps on the coarsest grid in a V-cycle.
constexpr int coarsest_sweeps = 4;
/// A grid of at most this many cells is processed by one warp.
constexpr int one_warp_cells = 64;

/// Position of a fluid cell in its grid. Lists of positions are kept in the thread block's scratch memory.
struct CellPlace {
  std::uint16_t x, y, z;
};

/// List of the fluid cells of one grid, so that passes skip all other cells. Cells of the checkerboard's
/// first colour are listed from the front, cells of its second colour from the back.
struct FluidCells {
  CellBlock block;
  CellPlace* place;
  int* count;  ///< number of listed cells per colour

  SIM_FN int size() const { return count[0] + count[1]; }
  SIM_FN int nth(int colour, int k) const { return colour == 0 ? k : block.size() - 1 - k; }
  template <class F>
  SIM_FN void visit(int at, const F& f) const {
    const Place p{place[at].x, place[at].y, place[at].z};
    f.cell(p, block.index(p.x, p.y, p.z));
  }
};

/// Calls f.cell for the fluid cells of one colour (OfColour) or of both colours (OfBoth).
template <class F>
struct OfColour {
  FluidCells cells;
  int colour;
  F f;
  SIM_FN void operator()(int k) const { cells.visit(cells.nth(colour, k), f); }
};
template <class F>
struct OfBoth {
  FluidCells cells;
  F f;
  SIM_FN void operator()(int k) const {
    const int first = cells.count[0];
    cells.visit(k < first ? k : cells.nth(1, k - first), f);
  }
};

/// Lists a grid's fluid cells, in any order, and sets q = 0 in all cells.
struct ListFluid {
  GridView grid;
  FluidCells to;
  SIM_FN void operator()(int i) const {
    grid.q[i] = 0;
    if (grid.kind[i] != CellKind::Fluid) return;
    const auto [x, y, z] = place_of(grid.block, i);
    const int colour = (x + y + z) & 1;
    to.place[to.nth(colour, atomic_next(to.count + colour))] = {
        static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)};
  }
};

/// Copies kinds and sources of the first small grid, the finest grid that one thread block solves, into the
/// block's memory.
struct Load {
  GridView from, to;
  SIM_FN void operator()(int i) const {
    to.kind[i] = from.kind[i];
    to.source[i] = from.source[i];
  }
};
/// Copies q of the first small grid back to global memory.
struct Store {
  GridView from, to;
  SIM_FN void operator()(int i) const { to.q[i] = from.q[i]; }
};
struct Nothing {
  int* count;
  SIM_FN void operator()(int i) const { count[i] = 0; }
};

/// V-cycles over the grids from the first one that is small enough for one block down to the coarsest. All
/// values are in the block's scratch memory.
struct SmallGrids {
  static constexpr int most = 16;
  struct Grid {
    CellBlock block;
    /// scale: edge of a cell, in finest cells. begin: index of the grid's first cell in the arrays that all
    /// small grids share.
    int scale, begin;
  };
  GridView outside;  ///< the first small grid, in global memory
  Grid grid[most];
  int count;
  int cells;  ///< number of cells of all small grids
  int few;    ///< index of the first grid that one warp processes; at most the index of the last grid
  int cycles;

  static constexpr std::size_t cell_bytes = 3 * sizeof(float) + sizeof(CellPlace) + sizeof(CellKind);
  std::size_t bytes() const { return counts_bytes + static_cast<std::size_t>(cells) * cell_bytes; }
  static constexpr std::size_t counts_bytes = 2 * most * sizeof(int);

  /// The steps of a V-cycle over the grids in scratch memory. Layout: counts, then q, sources and diagonals,
  /// then cell positions, then kinds.
  struct InRoom {
    const SmallGrids& grids;
    unsigned char* room;

    SIM_FN int* counts() const { return reinterpret_cast<int*>(room); }
    SIM_FN float* values() const { return reinterpret_cast<float*>(room + counts_bytes); }
    SIM_FN CellPlace* places() const { return reinterpret_cast<CellPlace*>(values() + 3 * grids.cells); }
    SIM_FN GridView view(int level) const {
      const Grid& at = grids.grid[level];
      GridView out = grids.outside;
      out.block = at.block;
      out.scale = at.scale;
      out.kind = reinterpret_cast<CellKind*>(places() + grids.cells) + at.begin;
      out.q = values() + at.begin;
      out.source = out.q + grids.cells;
      out.diagonal = out.source + grids.cells;
      return out;
    }
    SIM_FN FluidCells fluid(int level) const {
      const Grid& at = grids.grid[level];
      return {at.block, places() + at.begin, counts() + 2 * level};
    }
    template <class Threads>
    SIM_FN void smooth(Threads threads, int level, int first_colour) const {
      const GridView at = view(level);
      const FluidCells wet = fluid(level);
      for (int half = 0; half < 2; ++half) {
        const int colour = half == 0 ? first_colour : 1 - first_colour;
        const Smooth pass{at, colour, at.scale == 1};
        threads.each(wet.count[colour], OfColour<Smooth>{wet, colour, pass});
      }
    }
    template <class Threads>
    SIM_FN void descend(Threads threads, int from, int to) const {
      for (int level = from; level < to; ++level) {
        smooth(threads, level, 0);
        const GridView fine = view(level);
        const FluidCells wet = fluid(level + 1);
        const Restrict pass{fine, view(level + 1), fine.scale == 1};
        threads.each(wet.size(), OfBoth<Restrict>{wet, pass});
      }
    }
    template <class Threads>
    SIM_FN void ascend(Threads threads, int from, int to) const {
      for (int level = from - 1; level >= to; --level) {
        const GridView fine = view(level);
        const FluidCells wet = fluid(level);
        const Prolong pass{fine, view(level + 1), fine.scale == 1};
        threads.each(wet.size(), OfBoth<Prolong>{wet, pass});
        smooth(threads, level, 1);
      }
    }
    template <class Threads>
    SIM_FN void solve_few(Threads threads) const {
      const int last = grids.count - 1;
      descend(threads, grids.few, last);
      for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) smooth(threads, last, 0);
      ascend(threads, last, grids.few);
    }
    template <class Block>
    SIM_FN void prepare(Block block) const {
      block.spread(2 * grids.count, Nothing{counts()});
      block.each(view(0).block.size(), Load{grids.outside, view(0)});
      for (int level = 1; level < grids.count; ++level)
        block.each(view(level).block.size(), Coarsen{view(level - 1), view(level)});
      for (int level = 0; level < grids.count; ++level)
        block.spread(view(level).block.size(), ListFluid{view(level), fluid(level)});
      block.wait();
      for (int level = 0; level < grids.count; ++level)
        block.spread(fluid(level).size(), OfBoth<Weigh>{fluid(level), {view(level)}});
      block.wait();
    }
  };

  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* room) const {
    const InRoom here{*this, room};
    here.prepare(block);
    for (int c = 0; c < cycles; ++c) {
      here.descend(block, 0, few);
      block.by_one_warp([&](auto warp) { here.solve_few(warp); });
      here.ascend(block, few, 0);
    }
    block.each(grid[0].block.size(), Store{here.view(0), outside});
  }
};

}  // namespace

void Multigrid::fit(CellBlock finest, Vec3 conductance, CellKind top) {
  conductance_ = conductance;
  top_ = top;
  if (!levels_.empty()) {
    const CellBlock now = levels_.front().block;
    if (finest.nx == now.nx && finest.ny == now.ny && finest.nz == now.nz) return;
  }
  levels_.clear();
  for (CellBlock block = finest;; block = block.halved()) {
    levels_.emplace_back().block = block;
    if (block.nx <= coarsest_side && block.ny <= coarsest_side && block.nz <= coarsest_side) break;
  }
  const std::size_t small = first_small();
  for (std::size_t l = 0; l <= small; ++l) {
    Level& level = levels_[l];
    const auto size = static_cast<std::size_t>(level.block.size());
    level.kind.resize(size);
    level.q.resize(size);
    level.source.resize(size);
    if (l < small) level.diagonal.resize(size);
  }
}

GridView Multigrid::view(std::size_t level) {
  auto& at = levels_[level];
  return {.block = at.block,
          .finest = levels_.front().block,
          .conductance = conductance_,
          .scale = 1 << level,
          .kind = at.kind.data(),
          .q = at.q.data(),
          .source = at.source.data(),
          .diagonal = at.diagonal.data(),
          .open = open_.data(),
          .open_count = static_cast<int>(open_.size()),
          .top = top_};
}

void Multigrid::smooth(std::size_t level, int first_colour) {
  const GridView at = view(level);
  for (const int colour : {first_colour, 1 - first_colour}) {
    for_each("smooth", Smooth::size(at.block), Smooth{at, colour, level == 0});
  }
}

std::size_t Multigrid::first_small() const {
  std::size_t level = levels_.size() - 1;
  while (level > 0 && levels_.size() - level < SmallGrids::most &&
         levels_[level - 1].block.size() <= one_block_cells)
    --level;
  return level;
}

void Multigrid::cycle_small(int cycles) {
  const std::size_t small = first_small();
  SmallGrids grids{.outside = view(small), .grid = {}, .count = 0, .cells = 0, .few = 0, .cycles = cycles};
  for (std::size_t l = small; l < levels_.size(); ++l) {
    const CellBlock block = levels_[l].block;
    if (grids.count > 0 && levels_[l - 1].block.size() > one_warp_cells) grids.few = grids.count;
    grids.grid[grids.count++] = {block, 1 << l, grids.cells};
    grids.cells += block.size();
  }
  in_one_block("small grids", grids.grid[0].block.size(), grids.bytes(), room_, grids);
}

void Multigrid::cycle(std::size_t level) {
  if (level == first_small()) {
    cycle_small(1);
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
  if (small == 0) {
    cycle_small(cycles);
    return;
  }
  for (std::size_t l = 0; l < small; ++l) for_each("weigh cells", levels_[l].block.size(), Weigh{view(l)});
  levels_.front().q.zero();
  for (int c = 0; c < cycles; ++c) cycle(0);
}

}  // namespace sim::SIM_BACKEND
