#pragma once
/// Pictures in memory and as PNG files.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "stats/image/image.hpp"

namespace sim {

/// sRGB, 8 bits per channel, RGBA; row 0 is the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 * width * height bytes
};

/// The bytes of a PNG file. Errors (base::Error, at `place`): an empty picture, or an rgba array of the wrong
/// size.
std::string png_bytes(const Image& image, const std::string& place);
/// Decodes a PNG of any bit depth, grey or colour, to RGBA of 8 bits; at most 16,384 px per side. Errors
/// (base::Error, at `place`): truncated, not a PNG, too large.
Image png_of(std::string_view bytes, const std::string& place);

/// Writes a temporary file in the same folder and renames it. Errors (base::Error): an empty picture, not
/// writable, disk full.
void write_png(const std::filesystem::path& path, const Image& image);

/// Decodes a PNG file. Errors (base::Error): a missing file, and those of png_of().
Image read_png(const std::filesystem::path& path);

/// A picture in the format of the image metrics; row 0 is the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  stats::ImageView view() const { return {width, height, rgb}; }
};
/// The colours of an RGBA picture.
Picture without_alpha(const Image& image);

}  // namespace sim
