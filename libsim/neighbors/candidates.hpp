#pragma once
/// Neighbour candidates of the particles of one cell, gathered once for all of these particles; used to build
/// lists on the CPU.

#ifndef SIM_CUDA

#include <bit>
#include <vector>

#include "libsim/neighbors/grid.hpp"

namespace sim::SIM_BACKEND {

/// Table of 1 << k, because not every processor has per-lane variable shifts.
struct BitRow {
  std::uint32_t of[32];
  constexpr BitRow() : of{} {
    for (int k = 0; k < 32; ++k) of[k] = std::uint32_t{1} << k;
  }
};
inline constexpr BitRow bit_row{};

/// The particles of a search window of one grid, with one array per coordinate, so that distances are
/// computed in SIMD lanes.
class Candidates {
 public:
  /// Gathers the particles that can be near `self`, in ascending order. Reuses the last result for the same
  /// window: consecutive particles share cells. `build`: changes whenever cells or positions change.
  void gather(const CellTable& cells, int l, Vec4 self, float margin, const Vec4* predicted,
              std::uint64_t build) {
    const LevelCells& grid = cells.level[l];
    const CellTable::Window look = cells.window(grid, self, margin);
    const Window window{build,
                        grid.along_x(look.at.x - look.reach),
                        grid.along_x(look.at.x + look.reach),
                        look.first_y,
                        look.last_y,
                        look.first_z,
                        look.last_z};
    if (window == held_) return;
    held_ = window;
    const auto cell = [&](int x, int y, int z) { return grid.first + (y * grid.nz + z) * grid.nx + x; };
    who_.clear();
    for (int y = window.first_y; y <= window.last_y; ++y) {
      for (int z = window.first_z; z <= window.last_z; ++z) {
        const int end = cells.begin[cell(window.last_x, y, z) + 1];
        for (int j = cells.begin[cell(window.first_x, y, z)]; j < end; ++j) who_.push_back(j);
      }
    }
    const std::size_t groups = (who_.size() + at_once - 1) / at_once;
    const std::size_t rows = groups * at_once;
    if (x_.size() < rows) {
      for (auto* row : {&x_, &y_, &z_}) row->resize(rows);
    }
    for (std::size_t k = 0; k < who_.size(); ++k) {
      const Vec4 p = predicted[who_[k]];
      x_[k] = p.x;
      y_[k] = p.y;
      z_[k] = p.z;
    }
    for (std::size_t k = who_.size(); k < rows; ++k) x_[k] = y_[k] = z_[k] = far;
    rows_ = static_cast<int>(rows);
  }

  /// Calls visit(j) for all particles closer than sqrt(square) to `at`; square in m2.
  template <class Visit>
  void each_near(Vec4 at, float square, Visit visit) const {
    for (int first = 0; first < rows_; first += at_once) {
      const float* const x = x_.data() + first;
      const float* const y = y_.data() + first;
      const float* const z = z_.data() + first;
      std::uint32_t near_ones = 0;
#pragma omp simd reduction(| : near_ones)
      for (int k = 0; k < at_once; ++k) {
        const float dx = at.x - x[k];
        const float dy = at.y - y[k];
        const float dz = at.z - z[k];
        near_ones |= dx * dx + dy * dy + dz * dz < square ? bit_row.of[k] : 0;
      }
      for (; near_ones != 0; near_ones &= near_ones - 1) {
        visit(who_[static_cast<std::size_t>(first + std::countr_zero(near_ones))]);
      }
    }
  }

 private:
  static constexpr int at_once = 32;
  static constexpr float far = 1e18f;
  struct Window {
    std::uint64_t build;
    int first_x, last_x, first_y, last_y, first_z, last_z;
    bool operator==(const Window&) const = default;
  };
  Window held_{};
  std::vector<int> who_;
  std::vector<float> x_, y_, z_;
  int rows_ = 0;
};

}  // namespace sim::SIM_BACKEND

#endif
