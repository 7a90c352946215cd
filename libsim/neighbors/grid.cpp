#include "libsim/neighbors/grid.hpp"

namespace sim::SIM_BACKEND {

namespace {

SIM_FN int cell_coordinate(float x, float edge, int limit) {
  const float cell = floorf(x / edge);
  // One cell short of the field's ends, so that the neighbouring cells have keys too.
  const auto most = static_cast<float>(limit - 2);
  return static_cast<int>(at_most(at_least(cell, -most), most));
}

struct MakeKeys {
  const Vec4* predicted;
  const std::uint8_t* level;
  std::uint64_t* keys;
  int* order;
  float margin;
  SIM_FN void operator()(int i) const {
    const Vec4 p = predicted[i];
    const float edge = margin * p.w;
    keys[i] = cell_key({level[i], cell_coordinate(p.x, edge, cell_limit_xz),
                        cell_coordinate(p.y, edge, cell_limit_y), cell_coordinate(p.z, edge, cell_limit_xz)});
    order[i] = i;
  }
};

struct MarkHeads {
  const std::uint64_t* keys;
  int* heads;
  SIM_FN void operator()(int i) const { heads[i] = i == 0 || keys[i] != keys[i - 1]; }
};

/// cell_of holds the inclusive sum of the heads; turns it into indices and writes each cell's first particle.
struct ListCells {
  const std::uint64_t* keys;
  const int* heads;
  int* cell_of;
  int* cell_begin;
  std::uint64_t* cell_keys;
  int* cell_count;
  int n;
  SIM_FN void operator()(int i) const {
    const int cell = cell_of[i] - 1;
    cell_of[i] = cell;
    if (heads[i]) {
      cell_begin[cell] = i;
      cell_keys[cell] = keys[i];
    }
    if (i == n - 1) {
      cell_begin[cell + 1] = n;
      *cell_count = cell + 1;
    }
  }
};

/// Orders the particles within each cell by id, so that the result does not depend on the order before.
struct OrderWithinCells {
  const int* cell_begin;
  const int* cell_count;
  const int* id;
  int* order;

  SIM_FN void insertion_sort(int begin, int end) const {
    for (int i = begin + 1; i < end; ++i) {
      const int moving = order[i];
      int at = i;
      for (; at > begin && id[order[at - 1]] > id[moving]; --at) order[at] = order[at - 1];
      order[at] = moving;
    }
  }
  /// Crowded cells (all in one cell is a test case) would make insertion quadratic.
  SIM_FN void heap_sort(int begin, int end) const {
    const int size = end - begin;
    for (int start = size / 2 - 1; start >= 0; --start) sift(begin, start, size);
    for (int last = size - 1; last > 0; --last) {
      exchange(begin, begin + last);
      sift(begin, 0, last);
    }
  }
  SIM_FN void exchange(int a, int b) const {
    const int kept = order[a];
    order[a] = order[b];
    order[b] = kept;
  }
  SIM_FN void sift(int begin, int root, int size) const {
    for (int child = 2 * root + 1; child < size; child = 2 * root + 1) {
      if (child + 1 < size && id[order[begin + child + 1]] > id[order[begin + child]]) ++child;
      if (id[order[begin + root]] >= id[order[begin + child]]) return;
      exchange(begin + root, begin + child);
      root = child;
    }
  }
  SIM_FN void operator()(int cell) const {
    if (cell >= *cell_count) return;
    const int begin = cell_begin[cell];
    const int end = cell_begin[cell + 1];
    if (end - begin <= 48) {
      insertion_sort(begin, end);
    } else {
      heap_sort(begin, end);
    }
  }
};

struct FindRows {
  const std::uint64_t* cell_keys;
  const int* cell_begin;
  const int* cell_count;
  IndexRange* rows;
  SIM_FN void operator()(int cell) const {
    const int cells = *cell_count;
    if (cell >= cells) return;
    const CellCoordinates c = cell_of_key(cell_keys[cell]);
    for (int row = 0; row < Grid::rows_per_cell; ++row) {
      const int y = c.y + row / 3 - 1;
      const int z = c.z + row % 3 - 1;
      const std::uint64_t last = cell_key({c.level, c.x + 1, y, z});
      int at = lower_bound(cell_keys, cells, cell_key({c.level, c.x - 1, y, z}));
      const int begin = cell_begin[at];
      while (at < cells && cell_keys[at] <= last) ++at;
      rows[cell * Grid::rows_per_cell + row] = {begin, cell_begin[at]};
    }
  }
};

}  // namespace

void Grid::find_cells(int n) {
  const auto size = static_cast<std::size_t>(n);
  heads_.resize(size);
  cell_keys_.resize(size);
  cell_begin_.resize(size + 1);
  cell_count_.resize(1);
  for_each("mark cells", n, MarkHeads{keys_.data(), heads_.data()});
  scanner_.inclusive_sum(heads_, cell_of_);
  for_each("list cells", n,
           ListCells{keys_.data(), heads_.data(), cell_of_.data(), cell_begin_.data(), cell_keys_.data(),
                     cell_count_.data(), n});
}

void Grid::sort(Particles& particles, float margin) {
  const Reads<Column::Predicted, Column::Level, Column::Id> p(particles);
  const int n = particles.size();
  const auto size = static_cast<std::size_t>(n);
  // Once for all sizes to come.
  const auto room = static_cast<std::size_t>(particles.capacity());
  for (auto* column : {&keys_, &cell_keys_}) column->reserve(room);
  for (auto* column : {&order_, &heads_, &cell_of_}) column->reserve(room);
  cell_begin_.reserve(room + 1);
  keys_.resize(size);
  order_.resize(size);
  for_each("cell keys", n, MakeKeys{p.predicted(), p.level(), keys_.data(), order_.data(), margin});
  sorter_.sort(keys_, order_);
  find_cells(n);
  for_each("order within cells", n,
           OrderWithinCells{cell_begin_.data(), cell_count_.data(), p.id(), order_.data()});
  particles.reorder(order_);
}

void Grid::build(Particles& particles, float margin) {
  const int n = particles.size();
  if (n == 0) return;
  sort(particles, margin);
  rows_.reserve(static_cast<std::size_t>(particles.capacity()) * rows_per_cell);
  rows_.resize(static_cast<std::size_t>(n) * rows_per_cell);
  for_each("find rows", n, FindRows{cell_keys_.data(), cell_begin_.data(), cell_count_.data(), rows_.data()});
}

void Grid::build(Particles& particles, float margin, const LevelSupports& supports) {
  const int n = particles.size();
  if (n == 0) return;
  sort(particles, margin);
  level_rows_.find({cell_keys_.data(), cell_begin_.data(), cell_count_.data()}, n, particles.capacity(),
                   supports, margin);
}

int Grid::count_cells() const { return cell_count_.size() ? cell_count_.to_host()[0] : 0; }

}  // namespace sim::SIM_BACKEND
