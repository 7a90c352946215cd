#pragma once
/// A sorted, compact grid: particles ordered by (64-bit cell key, id), a list of the occupied cells, no array
/// over the domain. Each mass level has its own cell size, its key's top bits, and so its own run of the
/// list.

#include <cstdint>

#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Key fields from the lowest: x 22 bits, z 22, y 18, level 2. Cells +-2^21 (x, z) and +-2^17 (y) round the
/// origin.
struct CellCoordinates {
  int level, x, y, z;
};
constexpr int cell_limit_xz = 1 << 21;
constexpr int cell_limit_y = 1 << 17;

SIM_FN std::uint64_t cell_key(CellCoordinates c) {
  const auto field = [](int value, int limit) { return static_cast<std::uint64_t>(value + limit); };
  return static_cast<std::uint64_t>(c.level) << 62 | field(c.y, cell_limit_y) << 44 |
         field(c.z, cell_limit_xz) << 22 | field(c.x, cell_limit_xz);
}
SIM_FN CellCoordinates cell_of_key(std::uint64_t key) {
  constexpr std::uint64_t mask22 = (1u << 22) - 1;
  constexpr std::uint64_t mask18 = (1u << 18) - 1;
  return {static_cast<int>(key >> 62), static_cast<int>(key & mask22) - cell_limit_xz,
          static_cast<int>(key >> 44 & mask18) - cell_limit_y,
          static_cast<int>(key >> 22 & mask22) - cell_limit_xz};
}

/// Particles i with begin <= i < end.
struct IndexRange {
  int begin, end;
};

class Grid {
 public:
  /// Rows of three cells along x that make a cell's surroundings.
  static constexpr int rows_per_cell = 9;

  /// Sorts the particles by the cell of their predicted positions and permutes their columns. Cell edge =
  /// margin x h. Positions beyond the key's range share its outermost cells; pairs are still decided by
  /// distance, so none is lost or made up.
  void build(Particles& particles, float margin);

  /// For particle i: the cell it lies in; for cell c: its rows.
  const int* cell_of_particle() const { return cell_of_.data(); }
  const IndexRange* rows() const { return rows_.data(); }
  /// Occupied cells, read back from the device (a synchronisation; for tests and reports).
  int count_cells() const;

 private:
  void find_cells(int n);

  Sorter sorter_;
  Scanner scanner_;
  Array<std::uint64_t> keys_, cell_keys_;
  Array<int> order_, heads_, cell_of_, cell_begin_;
  Array<int> cell_count_;
  Array<IndexRange> rows_;
};

}  // namespace sim::SIM_BACKEND
