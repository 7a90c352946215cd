#pragma once
/// Orders the particles by (mass level, cell, id) with a counting sort over a table of bounded size.

#include "libsim/neighbors/cell_table.hpp"

namespace sim::SIM_BACKEND {

class Grid {
 public:
  /// Sorts particles of one support by the cell of their predicted positions and permutes their columns. The
  /// result does not depend on the previous order if ids are unique.
  void build(Particles& particles, float margin, const Domain& domain, float support);
  /// The same for mixed levels with the given supports.
  void build(Particles& particles, float margin, const Domain& domain, const LevelSupports& supports);

  CellTable cells() const {
    CellTable out = shape_;
    out.begin = begin_.data();
    out.met = finds_met && shape_.levels > 1 ? met_.data() : nullptr;
    return out;
  }
  /// Cells that hold particles, read back from the device (a synchronisation; for tests).
  int count_cells() const;
  /// Number of cells in the table.
  int size() const;

  /// Cells along the reach of a pair, margin x h: with finer cells fewer particles beyond the reach are
  /// tested, but there are more lines of cells. `across`: along y and z.
  struct CellsPerReach {
    double along_x, across;
  };
#ifdef SIM_CUDA
  /// Short lines are read in parallel. With several levels most lines of a window are almost empty, so fewer
  /// lines are faster; short cells keep the particles per line few.
  static constexpr CellsPerReach of_one_level{2, 2};
  static constexpr CellsPerReach of_levels{4, 1};
  /// Empty lines cost the GPU less than the two passes that find the levels of each block.
  static constexpr bool finds_met = false;
#else
  /// The CPU reads long lines in SIMD lanes.
  static constexpr CellsPerReach of_one_level{1, 1};
  static constexpr CellsPerReach of_levels{1, 1};
  static constexpr bool finds_met = true;
#endif
  /// Upper bound on the cells per particle of capacity, and a minimum table size; if the domain needs more,
  /// the cells are widened.
  static constexpr std::int64_t most_per_particle = 4;
  static constexpr std::int64_t always = 1 << 16;

 private:
  void shape(const Domain& domain, float margin, int capacity);
  void sort(Particles& particles, bool by_level);
  void find_met(Particles& particles);

  Scanner scanner_;
  CellTable shape_{};  ///< all but the array pointers
  Array<int> begin_, cell_of_, placed_, order_;
  Array<int> present_;  ///< 1 = the block contains particles of the level; the levels of a block are adjacent
  Array<std::uint8_t> met_;
};

}  // namespace sim::SIM_BACKEND
