#include "libsim/neighbors/level_rows.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Cells first <= c <= last along one axis.
struct CellSpan {
  int first, last;
};

/// Cells of a grid with edge `other_edge` that a particle in `cell` of a grid with edge `edge` reaches within
/// `radius`.
SIM_FN CellSpan reach(int cell, float edge, float other_edge, float radius, int limit) {
  const int most = limit - 2;
  const float low = (static_cast<float>(cell) * edge - radius) / other_edge;
  const float high = (static_cast<float>(cell + 1) * edge + radius) / other_edge;
  // Coordinates are rounded to floats before their cell is found.
  const float slack = 1e-3f + 1e-6f * at_least(fabsf(low), fabsf(high));
  const auto clamped = [most](float at) {
    return static_cast<int>(
        at_most(at_least(floorf(at), -static_cast<float>(most)), static_cast<float>(most)));
  };
  // The outermost cells hold everything beyond them, in every grid.
  return {cell <= -most ? -most : clamped(low - slack), cell >= most ? most : clamped(high + slack)};
}

constexpr int x_bits = 22;

struct MarkLines {
  CellList cells;
  int* heads;
  SIM_FN void operator()(int c) const {
    heads[c] = c < *cells.count && (c == 0 || cells.key[c] >> x_bits != cells.key[c - 1] >> x_bits) ? 1 : 0;
  }
};

/// line_of holds the inclusive sum of the heads.
struct ListLines {
  CellList cells;
  const int* heads;
  const int* line_of;
  std::uint64_t* line_keys;
  int* line_begin;
  int* line_count;
  SIM_FN void operator()(int c) const {
    const int count = *cells.count;
    if (c >= count) return;
    const int line = line_of[c] - 1;
    if (heads[c]) {
      line_begin[line] = c;
      line_keys[line] = cells.key[c] >> x_bits;
    }
    if (c == count - 1) {
      line_begin[line + 1] = count;
      *line_count = line + 1;
    }
  }
};

struct FindLevelRows {
  CellList cells;
  const std::uint64_t* line_keys;
  const int* line_begin;
  const int* line_count;
  LevelRow* rows;
  LevelBox* boxes;
  LevelSupports supports;
  float margin;

  SIM_FN static std::uint64_t line_key(int level, int y, int z) {
    return cell_key({level, 0, y, z}) >> x_bits;
  }

  SIM_FN void operator()(int index) const {
    const int cell = index / LevelSupports::most;
    const int other = index % LevelSupports::most;
    if (cell >= *cells.count) return;
    const CellCoordinates c = cell_of_key(cells.key[cell]);
    const float edge = margin * supports.h[c.level];
    const float other_edge = margin * supports.h[other];
    const float radius = 0.5f * (edge + other_edge);
    const bool same = other == c.level;
    const CellSpan x = same ? beside(c.x) : reach(c.x, edge, other_edge, radius, cell_limit_xz);
    const CellSpan y = same ? beside(c.y) : reach(c.y, edge, other_edge, radius, cell_limit_y);
    const CellSpan z = same ? beside(c.z) : reach(c.z, edge, other_edge, radius, cell_limit_xz);
    const int found = find(other, x, y, z, rows + static_cast<std::size_t>(index) * LevelRowsView::most_rows);
    boxes[index] = {found, other_edge, static_cast<float>(y.first) * other_edge,
                    static_cast<float>(z.first) * other_edge};
  }

  /// Particles of one level that are near each other lie in cells that touch.
  SIM_FN static CellSpan beside(int cell) { return {cell - 1, cell + 1}; }

  /// Walks the occupied lines of the box only; an absent level costs one search.
  SIM_FN int find(int level, CellSpan x, CellSpan y, CellSpan z, LevelRow* out) const {
    const int lines = *line_count;
    const std::uint64_t last = line_key(level, y.last, z.last);
    int found = 0;
    int at = lower_bound(line_keys, lines, line_key(level, y.first, z.first));
    while (at < lines && line_keys[at] <= last) {
      const CellCoordinates line = cell_of_key(line_keys[at] << x_bits);
      if (line.z < z.first || line.z > z.last) {
        const int next_y = line.z < z.first ? line.y : line.y + 1;
        at += lower_bound(line_keys + at, lines - at, line_key(level, next_y, z.first));
        continue;
      }
      const int first = line_begin[at];
      const int end = line_begin[at + 1];
      const int begin =
          first + lower_bound(cells.key + first, end - first, cell_key({level, x.first, line.y, line.z}));
      const std::uint64_t last_cell = cell_key({level, x.last, line.y, line.z});
      int after = begin;
      while (after < end && cells.key[after] <= last_cell) ++after;
      if (after > begin) {
        // The outermost cells hold everything beyond them.
        const bool inside = within(line.y, cell_limit_y) && within(line.z, cell_limit_xz);
        const int far = LevelRow::anywhere;
        add({cells.begin[begin], cells.begin[after]}, inside ? line.y - y.first : far,
            inside ? line.z - z.first : far, found, out);
      }
      ++at;
    }
    return found;
  }

  SIM_FN static bool within(int cell, int limit) { return cell > -(limit - 2) && cell < limit - 2; }

  /// When there is no more room, the last run grows over what lies between.
  SIM_FN static void add(IndexRange run, int y, int z, int& found, LevelRow* out) {
    if (found < LevelRowsView::most_rows) {
      out[found++] = LevelRow::make(run.begin, run.end - run.begin, y, z);
    } else {
      const int begin = out[found - 1].begin;
      out[found - 1] = LevelRow::make(begin, run.end - begin, LevelRow::anywhere, LevelRow::anywhere);
    }
  }
};

}  // namespace

void LevelRows::find(const CellList& cells, int n, int capacity, const LevelSupports& supports,
                     float margin) {
  const auto size = static_cast<std::size_t>(n);
  const auto room = static_cast<std::size_t>(capacity);
  for (auto* column : {&heads_, &line_of_, &line_begin_}) column->reserve(room + 1);
  line_keys_.reserve(room);
  heads_.resize(size);
  line_begin_.resize(size + 1);
  line_keys_.resize(size);
  line_count_.resize(1);
  for_each("mark lines", n, MarkLines{cells, heads_.data()});
  scanner_.inclusive_sum(heads_, line_of_);
  for_each("list lines", n,
           ListLines{cells, heads_.data(), line_of_.data(), line_keys_.data(), line_begin_.data(),
                     line_count_.data()});
  constexpr std::size_t levels = LevelSupports::most;
  boxes_.reserve(room * levels);
  boxes_.resize(size * levels);
  // Rows are many a cell: room grows with the particles in use, not with the capacity.
  if (rows_.size() < size * levels * LevelRowsView::most_rows) {
    rows_.resize(size * 5 / 4 * levels * LevelRowsView::most_rows);
  }
  for_each("find level rows", n * LevelSupports::most,
           FindLevelRows{cells, line_keys_.data(), line_begin_.data(), line_count_.data(), rows_.data(),
                         boxes_.data(), supports, margin});
}

}  // namespace sim::SIM_BACKEND
