#pragma once
/// Orders the particles by (mass level, cell, id) with a counting sort over a table of bounded size.

#include "libsim/neighbors/cell_table.hpp"

namespace sim::SIM_BACKEND {

class Grid {
 public:
  /// Sorts particles of one support by the cell of their predicted positions and permutes their columns. The
  /// order does not depend on the order before, as long as no two share an id.
  void build(Particles& particles, float margin, const Domain& domain, float support);
  /// The same for mixed levels, whose supports are the given ones.
  void build(Particles& particles, float margin, const Domain& domain, const LevelSupports& supports);

  CellTable cells() const {
    CellTable out = shape_;
    out.begin = begin_.data();
    out.met = finds_met && shape_.levels > 1 ? met_.data() : nullptr;
    return out;
  }
  /// Cells that hold particles, read back from the device (a synchronisation; for tests).
  int count_cells() const;
  /// Cells in the table.
  int size() const;

  /// Cells along the reach of a pair, margin x h: the finer they are, the fewer particles beyond it are
  /// looked at, and the more lines of cells. `across`: along y and z.
  struct CellsPerReach {
    double along_x, across;
  };
#ifdef SIM_CUDA
  /// Short lines are read side by side. With several levels most lines of a window are empty or nearly so,
  /// and fewer of them pay; short cells keep a line's particles few.
  static constexpr CellsPerReach of_one_level{2, 2};
  static constexpr CellsPerReach of_levels{4, 1};
  /// Empty lines cost the GPU less than the two passes that tell where a level is.
  static constexpr bool finds_met = false;
#else
  /// The CPU reads long lines in lanes.
  static constexpr CellsPerReach of_one_level{1, 1};
  static constexpr CellsPerReach of_levels{1, 1};
  static constexpr bool finds_met = true;
#endif
  /// The table has at most so many cells for each particle there is room for, and a least number; where the
  /// domain asks for more, the cells are wider.
  static constexpr std::int64_t most_per_particle = 4;
  static constexpr std::int64_t always = 1 << 16;

 private:
  void shape(const Domain& domain, float margin, int capacity);
  void sort(Particles& particles, bool by_level);
  void find_met(Particles& particles);

  Scanner scanner_;
  CellTable shape_{};  ///< but for what its arrays hold
  Array<int> begin_, cell_of_, placed_, order_;
  Array<int> present_;  ///< 1 = the block has particles of the level; levels of a block lie side by side
  Array<std::uint8_t> met_;
};

}  // namespace sim::SIM_BACKEND
