#pragma once
/// Cells as 64-bit keys, for the gradients of two supports (saliency/gradients.hpp).

#include <cstdint>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// Coordinates of a cell. Fields of its key from the lowest bits: x 22 bits, z 22, y 18, level 2. Range:
/// +-2^21 cells (x, z) and +-2^17 cells (y) from the origin.
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

/// The first index in keys[0 .. count) whose key is not less than `key`.
SIM_FN int lower_bound(const std::uint64_t* keys, int count, std::uint64_t key) {
  int first = 0;
  while (count > 0) {
    const int half = count / 2;
    if (keys[first + half] < key) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

}  // namespace sim::SIM_BACKEND
