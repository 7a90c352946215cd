#include "libsim/pressure/small_grids.hpp"

namespace sim::SIM_BACKEND {

/// The coarsest grid has at most this many cells along its longest side.
constexpr int coarsest_side = 2;

void Multigrid::fit(CellBlock finest, Vec3 conductance) {
  conductance_ = conductance;
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
          .open_count = static_cast<int>(open_.size())};
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
