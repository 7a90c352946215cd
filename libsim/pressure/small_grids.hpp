#pragma once
/// V-cycles over grids that are small enough for one block, in its own memory.

#include "libsim/exec/one_block.hpp"
#include "libsim/pressure/grid_passes.hpp"

namespace sim::SIM_BACKEND {

constexpr int coarsest_sweeps = 4;
/// A grid of at most so many cells is left to one warp.
constexpr int one_warp_cells = 64;

/// Takes what the first of the small grids is given, with q = 0,
struct Load {
  GridView from, to;
  SIM_FN void operator()(int i) const {
    to.kind[i] = from.kind[i];
    to.source[i] = from.source[i];
    to.q[i] = 0;
  }
};
/// and gives its q back.
struct Store {
  GridView from, to;
  SIM_FN void operator()(int i) const { to.q[i] = from.q[i]; }
};

/// The grids from the first one that is small enough for one block down to the coarsest: V-cycles over them.
/// All values live in the block's room.
struct SmallGrids {
  static constexpr int most = 16;
  struct Grid {
    CellBlock block;
    int scale, begin;  ///< cells before it in the room
  };
  GridView outside;  ///< the first one where others see it
  Grid grid[most];
  int count;
  int cells;  ///< of all
  int few;    ///< the first grid for one warp; the last one at most
  int cycles;

  std::size_t bytes() const {
    return static_cast<std::size_t>(cells) * (3 * sizeof(float) + sizeof(CellKind));
  }

  /// The steps of a V-cycle over the grids in a room.
  struct InRoom {
    const SmallGrids& grids;
    unsigned char* room;

    SIM_FN GridView view(int level) const {
      const Grid& at = grids.grid[level];
      auto* values = reinterpret_cast<float*>(room) + at.begin;
      auto* kinds =
          reinterpret_cast<CellKind*>(room + 3 * sizeof(float) * static_cast<unsigned>(grids.cells));
      GridView out = grids.outside;
      out.block = at.block;
      out.scale = at.scale;
      out.kind = kinds + at.begin;
      out.q = values;
      out.source = values + grids.cells;
      out.diagonal = values + 2 * grids.cells;
      return out;
    }
    template <class Threads>
    SIM_FN void smooth(Threads threads, int level, int first_colour) const {
      const GridView at = view(level);
      for (int half = 0; half < 2; ++half) {
        const int colour = half == 0 ? first_colour : 1 - first_colour;
        threads.each(Smooth::size(at.block), Smooth{at, colour, at.scale == 1});
      }
    }
    template <class Threads>
    SIM_FN void descend(Threads threads, int from, int to) const {
      for (int level = from; level < to; ++level) {
        smooth(threads, level, 0);
        const GridView fine = view(level);
        const GridView coarse = view(level + 1);
        threads.each(coarse.block.size(), Restrict{fine, coarse, fine.scale == 1});
      }
    }
    template <class Threads>
    SIM_FN void ascend(Threads threads, int from, int to) const {
      for (int level = from - 1; level >= to; --level) {
        const GridView fine = view(level);
        threads.each(fine.block.size(), Prolong{fine, view(level + 1), fine.scale == 1});
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
      block.each(view(0).block.size(), Load{grids.outside, view(0)});
      for (int level = 1; level < grids.count; ++level)
        block.each(view(level).block.size(), Coarsen{view(level - 1), view(level)});
      for (int level = 0; level < grids.count; ++level)
        block.spread(view(level).block.size(), Weigh{view(level)});
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

}  // namespace sim::SIM_BACKEND
