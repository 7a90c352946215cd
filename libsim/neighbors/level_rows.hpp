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

/// A run of particles in one line of cells along x, and where that line lies in its box.
struct LevelRow {
  int begin;
  std::uint32_t packed;  ///< size in the lower 26 bits, then y and z in cells from the box's corner

  static constexpr int most_size = (1 << 26) - 1;
  static constexpr int anywhere = 7;  ///< a place that stands for more than one line
  SIM_FN static LevelRow make(int begin, int size, int y, int z) {
    const bool placed = y < anywhere && z < anywhere;
    const auto bits = static_cast<std::uint32_t>(placed ? z << 3 | y : anywhere << 3 | anywhere);
    return {begin, bits << 26 | static_cast<std::uint32_t>(size)};
  }
  SIM_FN int size() const { return static_cast<int>(packed & static_cast<std::uint32_t>(most_size)); }
  SIM_FN int y() const { return static_cast<int>(packed >> 26 & 7u); }
  SIM_FN int z() const { return static_cast<int>(packed >> 29); }
};

/// The cells of one level that a cell's particles can reach: their rows, their edge (margin x h) and the
/// box's low corner, m.
struct LevelBox {
  int rows;
  float edge, y, z;

  /// Whether a row's cells all lie farther from x than `reach`, measured across the row.
  SIM_FN bool misses(const LevelRow& row, Vec4 x, float reach) const {
    if (row.y() == LevelRow::anywhere) return false;
    const float low_y = y + static_cast<float>(row.y()) * edge - x.y;
    const float low_z = z + static_cast<float>(row.z()) * edge - x.z;
    const float dy = at_least(at_least(low_y, -(low_y + edge)), 0.0f);
    const float dz = at_least(at_least(low_z, -(low_z + edge)), 0.0f);
    // Coordinates were rounded when their cell was found.
    const float slack = 1e-3f * edge + 2e-6f * (fabsf(x.y) + fabsf(x.z));
    const float limit = reach + slack;
    return dy * dy + dz * dz > limit * limit;
  }
};

/// Runs of particles by (cell, other level), as kernels see them.
struct LevelRowsView {
  static constexpr int most_rows = 36;
  const LevelRow* rows;
  const LevelBox* boxes;
  SIM_FN LevelBox box(int cell, int level) const { return boxes[cell * LevelSupports::most + level]; }
  SIM_FN LevelRow operator()(int cell, int level, int row) const {
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
  LevelRowsView view() const { return {rows_.data(), boxes_.data()}; }
  std::size_t bytes() const {
    return line_of_.bytes() + heads_.bytes() + line_begin_.bytes() + line_count_.bytes() +
           line_keys_.bytes() + rows_.bytes() + boxes_.bytes();
  }

 private:
  Scanner scanner_;
  // Lines: the occupied cells of one level with the same y and z.
  Array<int> heads_, line_of_, line_begin_, line_count_;
  Array<std::uint64_t> line_keys_;
  Array<LevelRow> rows_;
  Array<LevelBox> boxes_;
};

}  // namespace sim::SIM_BACKEND
