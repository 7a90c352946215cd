#include "stats/base/picture_size.hpp"

#include <fmt/core.h>
#include <charconv>

#include "stats/base/error.hpp"

namespace base {

namespace {

constexpr double bytes_per_pixel = 40;

bool good_side(int px) { return px >= least_picture_side && px <= most_picture_side; }

}  // namespace

std::string size_words(PictureSize size) { return fmt::format("{}x{}", size.width, size.height); }

PictureSize parse_picture_size(const std::string& text, const std::string& option) {
  PictureSize size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool cross = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = cross ? std::from_chars(width.ptr + 1, end, size.height) : width;
  const std::string place = option + " " + text.substr(0, 40);
  if (!cross || height.ec != std::errc() || height.ptr != end || !good_side(size.width) ||
      !good_side(size.height)) {
    throw Error(place, "is not a size of 16 to 8192 px a side", "write width x height, such as 1280x720");
  }
  const auto pixels = static_cast<long long>(size.width) * size.height;
  if (pixels > most_picture_pixels) {
    throw Error(place,
                fmt::format("would take about {:.1f} GB of memory to draw",
                            1e-9 * bytes_per_pixel * static_cast<double>(pixels)),
                "use at most 33554432 pixels in all, such as 8192x4096");
  }
  return size;
}

}  // namespace base
