#pragma once
/// Pictures that a cell of a sweep stores, to be compared when a table is made.

#include <cstdint>
#include <string>
#include <vector>

namespace study {

struct KeptPicture {
  double time_s = 0;  ///< since the gate opened
  std::string png;
  /// Masks for comparison, packed by to_bits(); only the reference has them, on the first picture of each
  /// pair.
  std::string fovea = {}, salient = {};
};

/// Packs a byte mask (0 or not) into one bit per pixel, lowest bit first.
std::string to_bits(const std::vector<std::uint8_t>& mask);
/// One byte per pixel, 1 or 0; empty if there are fewer bits than pixels.
std::vector<std::uint8_t> from_bits(const std::string& bits, std::size_t pixels);

}  // namespace study
