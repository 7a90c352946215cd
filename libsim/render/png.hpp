#pragma once
/// Pictures in memory and as PNG files.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sim {

/// sRGB, 8 bits a channel, RGBA; row 0 is the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 * width * height bytes
};

/// Written to a temporary neighbour and renamed. Errors (base::Error): no picture, not writable, disk full.
void write_png(const std::filesystem::path& path, const Image& image);

/// Any PNG of 8 or 16 bits, grey or colour, widened to RGBA; at most 16,384 px a side. Errors (base::Error):
/// missing, truncated, not a PNG.
Image read_png(const std::filesystem::path& path);

}  // namespace sim
