#pragma once
/// A sorted, compact grid: particles ordered by (64-bit cell key, id), a list of the occupied cells, no array
/// over the domain. Each mass level has its own cell size, its key's top bits, and so its own run of the
/// list.

#include "libsim/neighbors/level_rows.hpp"

namespace sim::SIM_BACKEND {

class Grid {
 public:
  /// Rows of three cells along x that make a cell's surroundings.
  static constexpr int rows_per_cell = 9;

  /// Sorts the particles by the cell of their predicted positions and permutes their columns. Cell edge =
  /// margin x h. Positions beyond the key's range share its outermost cells; pairs are still decided by
  /// distance, so none is lost or made up.
  void build(Particles& particles, float margin);
  /// The same for mixed levels, whose supports are the given ones; level_rows() instead of rows().
  void build(Particles& particles, float margin, const LevelSupports& supports);

  /// For particle i: the cell it lies in; for cell c: its rows.
  const int* cell_of_particle() const { return cell_of_.data(); }
  const IndexRange* rows() const { return rows_.data(); }
  LevelRowsView level_rows() const { return level_rows_.view(); }
  /// Occupied cells, read back from the device (a synchronisation; for tests and reports).
  int count_cells() const;

 private:
  void sort(Particles& particles, float margin);
  void find_cells(int n);

  Sorter sorter_;
  Scanner scanner_;
  Array<std::uint64_t> keys_, cell_keys_;
  Array<int> order_, heads_, cell_of_, cell_begin_;
  Array<int> cell_count_;
  Array<IndexRange> rows_;
  LevelRows level_rows_;
};

}  // namespace sim::SIM_BACKEND
