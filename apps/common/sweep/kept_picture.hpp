#pragma once
/// Pictures that a cell of a sweep keeps, so that what was seen can be compared when a table is made.

#include <cstdint>
#include <string>
#include <vector>

namespace apps {

struct KeptPicture {
  double time_s = 0;  ///< since the gate opened
  std::string png;
  /// Masks for comparing, of the reference alone and of the first of two pictures: to_bits.
  std::string fovea = {}, salient = {};
};

/// A bit a pixel of a mask of bytes (0 or not), the first in the lowest bit.
std::string to_bits(const std::vector<std::uint8_t>& mask);
/// A byte a pixel, 1 or 0; empty where there are fewer bits than pixels.
std::vector<std::uint8_t> from_bits(const std::string& bits, std::size_t pixels);

}  // namespace apps
