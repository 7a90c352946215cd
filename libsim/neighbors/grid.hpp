#pragma once
/// Cells over the tank for the neighbour search: one grid per mass level, all in one table with the index of
/// each cell's first particle. The outermost cells of a grid also contain all particles beyond them, so that
/// far positions cost no memory and no pair is lost.

#include "libsim/particles/cells.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Particles i with begin <= i < end.
struct IndexRange {
  int begin, end;
};

/// The grid of one level. Cells lie in lines along x; lines are ordered along z, then along y.
struct LevelCells {
  float support;    ///< support radius h of the level's particles, m
  float edge;       ///< edge of the cells along y and z, m
  float inverse;    ///< 1 / edge, 1/m
  float inverse_x;  ///< 1 / edge along x, where cells may be shorter, 1/m
  int nx, ny, nz;
  int first;  ///< index of the grid's first cell in the table

  SIM_FN int size() const { return nx * ny * nz; }
  /// The cell of a position relative to the low corner, as an index within this grid.
  SIM_FN int of(Vec3 at) const { return (along(at.y, ny) * nz + along(at.z, nz)) * nx + along_x(at.x); }
  /// The cell along y or z at distance `x` from the low corner: 1 .. count - 2 inside the domain.
  SIM_FN int along(float x, int count) const { return floor_within(x * inverse, -1, count - 2) + 1; }
  SIM_FN int along_x(float x) const { return floor_within(x * inverse_x, -1, nx - 2) + 1; }
  /// x clamped to the nominal outer sides of the outermost cells.
  SIM_FN float nominal(float x, int count) const {
    return at_most(at_least(x, -edge), static_cast<float>(count - 1) * edge);
  }
  /// Distance of x, a nominal position, from a cell's slab along y or z, m: never more than the distance from
  /// a particle of this cell.
  SIM_FN float gap(float x, int cell) const {
    const float low = static_cast<float>(cell - 1) * edge - x;
    return at_least(at_least(low, -(low + edge)), 0.0f);
  }
};

/// The cells of the grids of all levels, in one table, in the form that kernels use.
struct CellTable {
  LevelCells level[LevelSupports::most];
  int levels;        ///< number of levels in use
  Vec3 low;          ///< low corner of the domain
  const int* begin;  ///< index of each cell's first particle; one more entry with the number of particles
  /// Blocks as wide as the longest search radius. met: per block, a bit mask of the levels that its particles
  /// can have as neighbours; most blocks have one or two such levels. nullptr if the levels were not
  /// determined (Grid::finds_met).
  LevelCells blocks;
  const std::uint8_t* met;

  SIM_FN int cell(int l, Vec4 p) const { return level[l].first + level[l].of(xyz(p) - low); }
  /// True if a particle at p can have neighbours of level l.
  SIM_FN bool meets(Vec4 p, int l) const {
    if (met) return met[blocks.of(xyz(p) - low)] >> l & 1;
    return begin[level[l].first] < begin[level[l].first + level[l].size()];
  }

  /// The search window of a particle in the grid of one level: lines of cells from (first_y, first_z) to
  /// (last_y, last_z).
  struct Window {
    Vec3 at;  ///< relative to the low corner; y and z are nominal
    float reach;
    int first_y, last_y, first_z, last_z;
  };
  /// The window that contains all particles within margin x (h + h_other) / 2.
  SIM_FN Window window(const LevelCells& grid, Vec4 self, float margin) const {
    const Vec3 at = xyz(self) - low;
    // The factor and the last term exceed the rounding errors of positions, distances and cells.
    const float reach = 1.0001f * (0.5f * margin * (self.w + grid.support)) +
                        1e-6f * (fabsf(at.x) + fabsf(at.y) + fabsf(at.z));
    return {{at.x, grid.nominal(at.y, grid.ny), grid.nominal(at.z, grid.nz)},
            reach,
            grid.along(at.y - reach, grid.ny),
            grid.along(at.y + reach, grid.ny),
            grid.along(at.z - reach, grid.nz),
            grid.along(at.z + reach, grid.nz)};
  }
  /// The particles of one line of cells that can be within the search radius.
  SIM_FN IndexRange line(const LevelCells& grid, const Window& look, int y, int z) const {
    const float dy = grid.gap(look.at.y, y);
    const float dz = grid.gap(look.at.z, z);
    const float left = look.reach * look.reach - dy * dy - dz * dz;
    if (!(left > 0)) return {0, 0};
    const float half = rough_root(left);
    const int cell = grid.first + (y * grid.nz + z) * grid.nx;
    return {begin[cell + grid.along_x(look.at.x - half)], begin[cell + grid.along_x(look.at.x + half) + 1]};
  }

  /// Calls visit(begin, end) for runs of particles, in ascending order, that contain the particle itself and
  /// all within margin x (h + h_other) / 2 of it.
  template <class Visit>
  SIM_FN void around(Vec4 self, float margin, Visit visit) const {
    for (int l = 0; l < levels; ++l) {
      if (!meets(self, l)) continue;
      const LevelCells& grid = level[l];
      const Window look = window(grid, self, margin);
      for (int y = look.first_y; y <= look.last_y; ++y) {
        for (int z = look.first_z; z <= look.last_z; ++z) {
          const IndexRange run = line(grid, look, y, z);
          if (run.begin < run.end) visit(run.begin, run.end);
        }
      }
    }
  }
};

/// Orders the particles by (mass level, cell, id) with a counting sort over a table of bounded size.
class Grid {
 public:
  /// Sorts particles of one support by the cell of their predicted positions and permutes their columns. The
  /// result does not depend on the previous order if ids are unique.
  void build(Particles& particles, float margin, const Domain& domain, float support);
  /// Sorts particles of mixed levels with the given supports by level, cell and id.
  void build(Particles& particles, float margin, const Domain& domain, const LevelSupports& supports);

  CellTable cells() const {
    CellTable out = shape_;
    out.begin = begin_.data();
    out.met = finds_met && shape_.levels > 1 ? met_.data() : nullptr;
    return out;
  }
  /// Number of cells that contain particles, read back from the device (a synchronisation; for tests).
  int count_cells() const;
  /// Number of cells in the table.
  int size() const;

  /// Number of cells per search radius, margin x h. Finer cells exclude more particles beyond the radius, but
  /// there are more lines of cells. `across`: along y and z.
  struct CellsPerReach {
    double along_x, across;
  };
#ifdef SIM_CUDA
  /// On the GPU, threads read lines of cells in parallel. With several levels most lines of a search window
  /// are almost empty. Wide cells across make these lines fewer, and short cells along x exclude most
  /// particles beyond the search radius.
  static constexpr CellsPerReach of_one_level{2, 2};
  static constexpr CellsPerReach of_levels{4, 1};
  /// Empty lines cost the GPU less than the two passes that find the levels of each block.
  static constexpr bool finds_met = false;
#else
  /// On the CPU, cells are as long as the search radius, because SIMD lanes read long lines fast.
  static constexpr CellsPerReach of_one_level{1, 1};
  static constexpr CellsPerReach of_levels{1, 1};
  static constexpr bool finds_met = true;
#endif
  /// A table has at most max(always, most_per_particle x capacity) cells. If the domain needs more, the cells
  /// are widened.
  static constexpr std::int64_t most_per_particle = 4;
  static constexpr std::int64_t always = 1 << 16;

 private:
  void shape(const Domain& domain, float margin, int capacity);
  void sort(Particles& particles, bool by_level);
  void find_met(Particles& particles);

  Scanner scanner_;
  CellTable shape_{};  ///< the table without its array pointers, which cells() adds
  Array<int> begin_, cell_of_, placed_, order_;
  /// 1 = the block contains particles of the level; the entries of a block's levels are adjacent
  Array<int> present_;
  Array<std::uint8_t> met_;
};

}  // namespace sim::SIM_BACKEND
