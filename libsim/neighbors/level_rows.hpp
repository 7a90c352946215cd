#pragma once
/// Where the neighbours of a cell's particles can be when levels are mixed: each level has a grid with a cell
/// edge of its own, so that a cell looks at another level through the box that its particles' reach covers
/// there.

#include "libsim/neighbors/cell_key.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// The sorted list of occupied cells as kernels see it. begin[count] is the number of particles.
struct CellList {
  const std::uint64_t* key;
  const int* begin;
  const int* count;
};

/// Runs of particles by (cell, other level), as kernels see them.
struct LevelRowsView {
  static constexpr int most_rows = 36;
  const IndexRange* rows;
  const int* count;
  SIM_FN int size(int cell, int level) const { return count[cell * LevelSupports::most + level]; }
  SIM_FN IndexRange operator()(int cell, int level, int row) const {
    return rows[static_cast<std::size_t>(cell * LevelSupports::most + level) * most_rows +
                static_cast<std::size_t>(row)];
  }
};

class LevelRows {
 public:
  /// Lists, for each of at most n cells and each level, the particles of that level that can lie within
  /// margin x (h_i + h_j) / 2 of a particle of the cell, as at most most_rows runs in ascending order. A run
  /// may hold particles farther away, but each particle appears once.
  void find(const CellList& cells, int n, int capacity, const LevelSupports& supports, float margin);
  LevelRowsView view() const { return {rows_.data(), count_.data()}; }
  std::size_t bytes() const {
    return line_of_.bytes() + heads_.bytes() + line_begin_.bytes() + line_count_.bytes() +
           line_keys_.bytes() + rows_.bytes() + count_.bytes();
  }

 private:
  Scanner scanner_;
  // Lines: the occupied cells of one level with the same y and z.
  Array<int> heads_, line_of_, line_begin_, line_count_;
  Array<std::uint64_t> line_keys_;
  Array<IndexRange> rows_;
  Array<int> count_;
};

}  // namespace sim::SIM_BACKEND
