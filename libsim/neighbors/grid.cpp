#include "libsim/neighbors/grid.hpp"

#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Counts the particles of each cell (in counts[cell + 1]), and stores for each particle how many particles
/// of its cell were counted before it.
struct CountCells {
  const Vec4* predicted;
  const std::uint8_t* level;  ///< level of each particle; nullptr: all have one level
  CellTable cells;
  int* counts;
  int* cell_of;
  int* arrival;
  SIM_FN void operator()(int i) const {
    const int cell = cells.cell(level ? level[i] : 0, predicted[i]);
    cell_of[i] = cell;
    arrival[i] = atomic_take(counts + cell + 1, 1);
  }
};

struct MarkPresent {
  const Vec4* predicted;
  const std::uint8_t* level;
  CellTable cells;
  int* present;
  SIM_FN void operator()(int i) const {
    const int block = cells.blocks.of(xyz(predicted[i]) - cells.low);
    atomic_raise(present + block * LevelSupports::most + level[i]);
  }
};

/// Finds the levels that particles of a block can have as neighbours: those in the block and in the adjacent
/// blocks.
struct Meet {
  const int* present;
  LevelCells blocks;
  std::uint8_t* met;
  SIM_FN void operator()(int block) const {
    const int x = block % blocks.nx;
    const int z = block / blocks.nx % blocks.nz;
    const int y = block / blocks.nx / blocks.nz;
    unsigned out = 0;
    for (int b = y - 1; b <= y + 1; ++b) {
      for (int c = z - 1; c <= z + 1; ++c) {
        for (int a = x - 1; a <= x + 1; ++a) {
          if (a < 0 || b < 0 || c < 0 || a >= blocks.nx || b >= blocks.ny || c >= blocks.nz) continue;
          const int* const levels = present + ((b * blocks.nz + c) * blocks.nx + a) * LevelSupports::most;
          for (int l = 0; l < LevelSupports::most; ++l) out |= static_cast<unsigned>(levels[l]) << l;
        }
      }
    }
    met[block] = static_cast<std::uint8_t>(out);
  }
};

struct PlaceInCell {
  const int* begin;
  const int* cell_of;
  const int* arrival;
  int* placed;
  SIM_FN void operator()(int i) const { placed[begin[cell_of[i]] + arrival[i]] = i; }
};

/// Sorts the particles within each cell by id, so that the result does not depend on the previous order.
struct OrderWithinCells {
  const int* begin;
  const int* cell_of;
  const int* placed;
  const int* id;
  int* order;

  /// Cells with more particles than this use heap sort, because the time of pairwise counting is quadratic.
  static constexpr int crowd = 64;

  SIM_FN bool before(int a, int b) const { return id[a] < id[b] || (id[a] == id[b] && a < b); }

  SIM_FN void operator()(int slot) const {
    const int i = placed[slot];
    const int first = begin[cell_of[i]];
    const int end = begin[cell_of[i] + 1];
    if (end - first > crowd) {
      if (slot == first) heap_sort(first, end);
      return;
    }
    int rank = 0;
    for (int k = first; k < end; ++k) rank += before(placed[k], i);
    order[first + rank] = i;
  }

  SIM_FN void heap_sort(int first, int end) const {
    for (int k = first; k < end; ++k) order[k] = placed[k];
    const int size = end - first;
    for (int root = size / 2 - 1; root >= 0; --root) sift(first, root, size);
    for (int last = size - 1; last > 0; --last) {
      exchange(first, first + last);
      sift(first, 0, last);
    }
  }
  SIM_FN void exchange(int a, int b) const {
    const int kept = order[a];
    order[a] = order[b];
    order[b] = kept;
  }
  SIM_FN void sift(int first, int root, int size) const {
    for (int child = 2 * root + 1; child < size; child = 2 * root + 1) {
      if (child + 1 < size && before(order[first + child], order[first + child + 1])) ++child;
      if (!before(order[first + root], order[first + child])) return;
      exchange(first + root, first + child);
      root = child;
    }
  }
};

/// Grid over the domain with cells of `edge` along y and z, and `edge_x` along x; plus one outermost cell at
/// each end of each axis.
LevelCells cells_of(Vec3 size, double edge, double edge_x, float support) {
  const auto count = [](float length, double of_one) {
    const double inside = std::ceil(std::max(static_cast<double>(length), 0.0) / of_one);
    return static_cast<int>(std::min(inside, 1e6)) + 2;
  };
  const auto narrow = static_cast<float>(edge);
  return {.support = support,
          .edge = narrow,
          .inverse = 1 / narrow,
          .inverse_x = 1 / static_cast<float>(edge_x),
          .nx = count(size.x, edge_x),
          .ny = count(size.y, edge),
          .nz = count(size.z, edge),
          .first = 0};
}

/// Height of the grid, as a multiple of the domain's height; above 1, because water splashes above the rim.
/// Particles above the grid share the uppermost cells.
constexpr float headroom = 1.5f;

}  // namespace

void Grid::shape(const Domain& domain, float margin, int capacity) {
  Vec3 size = domain.high - domain.low;
  size.y *= headroom;
  shape_.low = domain.low;
  const std::int64_t most = std::max(always, most_per_particle * capacity);
  for (int l = 0; l < shape_.levels; ++l) {
    if (!(shape_.level[l].support > 0))
      throw base::Error("grid of the neighbour search",
                        "level " + std::to_string(l) + " has no support radius",
                        "set the support radius of every level before the neighbour search");
  }
  const CellsPerReach cells = shape_.levels > 1 ? of_levels : of_one_level;
  const double edge_x = static_cast<double>(margin) / cells.along_x;
  const double edge = static_cast<double>(margin) / cells.across;
  for (double wider = 1;; wider *= 1.1) {
    double sum = 0;
    int first = 0;
    for (int l = 0; l < shape_.levels; ++l) {
      LevelCells& grid = shape_.level[l];
      const auto support = static_cast<double>(grid.support);
      grid = cells_of(size, wider * edge * support, wider * edge_x * support, grid.support);
      sum += static_cast<double>(grid.nx) * grid.ny * grid.nz;
      if (sum > static_cast<double>(most)) break;
      grid.first = first;
      first += grid.size();
    }
    if (sum > static_cast<double>(most)) continue;
    const float widest = shape_.level[shape_.levels - 1].support;
    // The factor 1.001 and the term with 1e-5 make blocks wider than the search radius by more than the
    // rounding errors in CellTable::window.
    const double block = wider * 1.001 * static_cast<double>(margin * widest) +
                         1e-5 * static_cast<double>(size.x + size.y + size.z);
    shape_.blocks = cells_of(size, block, block, widest);
    return;
  }
}

void Grid::find_met(Particles& particles) {
  const Reads<Column::Predicted, Column::Level> p(particles);
  const auto blocks = static_cast<std::size_t>(shape_.blocks.size());
  present_.resize(blocks * LevelSupports::most);
  present_.zero();
  met_.resize(blocks);
  for_each("mark levels", p.size(), MarkPresent{p.predicted(), p.level(), shape_, present_.data()});
  for_each("meet levels", shape_.blocks.size(), Meet{present_.data(), shape_.blocks, met_.data()});
}

void Grid::sort(Particles& particles, bool by_level) {
  const Reads<Column::Predicted, Column::Level, Column::Id> p(particles);
  const int n = particles.size();
  // Reserve the capacity at once, so that later sizes need no allocation.
  const auto room = static_cast<std::size_t>(particles.capacity());
  for (auto* column : {&cell_of_, &placed_, &order_}) {
    column->reserve(room);
    column->resize(static_cast<std::size_t>(n));
  }
  begin_.resize(static_cast<std::size_t>(size()) + 1);
  begin_.zero();
  // order_ also stores the arrival numbers, which are no longer needed when the order is written.
  int* const arrival = order_.data();
  for_each("count cells", n,
           CountCells{p.predicted(), by_level ? p.level() : nullptr, shape_, begin_.data(), cell_of_.data(),
                      arrival});
  scanner_.inclusive_sum(begin_, begin_);
  for_each("place by cell", n, PlaceInCell{begin_.data(), cell_of_.data(), arrival, placed_.data()});
  for_each("order within cells", n,
           OrderWithinCells{begin_.data(), cell_of_.data(), placed_.data(), p.id(), order_.data()});
  particles.reorder(order_);
}

void Grid::build(Particles& particles, float margin, const Domain& domain, float support) {
  if (particles.size() == 0) return begin_.zero();
  shape_.levels = 1;
  shape_.level[0].support = support;
  shape(domain, margin, particles.capacity());
  sort(particles, false);
}

void Grid::build(Particles& particles, float margin, const Domain& domain, const LevelSupports& supports) {
  if (particles.size() == 0) return begin_.zero();
  shape_.levels = LevelSupports::most;
  for (int l = 0; l < LevelSupports::most; ++l) shape_.level[l].support = supports.h[l];
  shape(domain, margin, particles.capacity());
  sort(particles, true);
  if (finds_met) find_met(particles);
}

int Grid::size() const {
  if (shape_.levels == 0) return 0;
  const LevelCells& last = shape_.level[shape_.levels - 1];
  return last.first + last.size();
}

int Grid::count_cells() const {
  const auto begin = begin_.to_host();
  int out = 0;
  for (std::size_t c = 1; c < begin.size(); ++c) out += begin[c] > begin[c - 1];
  return out;
}

}  // namespace sim::SIM_BACKEND
