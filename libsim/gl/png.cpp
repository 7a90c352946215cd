#include "libsim/gl/png.hpp"

#include <png.h>

#include <cstring>
#include <string>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace sim {

namespace {
constexpr std::size_t max_file_bytes = std::size_t{1} << 30;
constexpr png_uint_32 max_side_px = 16384;
}  // namespace

std::string png_bytes(const Image& image, const std::string& place) {
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(image.width);
  if (image.width < 1 || image.height < 1 ||
      image.rgba.size() != row_bytes * static_cast<std::size_t>(image.height)) {
    throw base::Error(place,
                      "the picture to write has " + std::to_string(image.width) + " x " +
                          std::to_string(image.height) + " px and " + std::to_string(image.rgba.size()) +
                          " bytes",
                      "give at least 1 x 1 px, with 4 bytes per pixel");
  }
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGBA;
  header.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr)) {
    throw base::Error(place, std::string("PNG encoding failed: ") + header.message, "use a smaller picture");
  }
  bytes.resize(size);
  return bytes;
}

Image png_of(std::string_view bytes, const std::string& place) {
  const std::string mend = "use an intact PNG file";
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) {
    throw base::Error(place, std::string("not a readable PNG: ") + header.message, mend);
  }
  if (header.width > max_side_px || header.height > max_side_px) {
    png_image_free(&header);
    throw base::Error(place,
                      "has " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                          " px; at most " + std::to_string(max_side_px) + " px a side are read",
                      "use a smaller picture");
  }
  header.format = PNG_FORMAT_RGBA;
  Image image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.rgba.resize(PNG_IMAGE_SIZE(header));
  if (!png_image_finish_read(&header, nullptr, image.rgba.data(), 0, nullptr)) {
    throw base::Error(place, std::string("damaged PNG: ") + header.message, mend);
  }
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  base::write_file_atomically(path, png_bytes(image, path.string()));
}

Image read_png(const std::filesystem::path& path) {
  return png_of(base::read_file(path, max_file_bytes), path.string());
}

Picture without_alpha(const Image& image) {
  Picture out{image.width, image.height, {}};
  const std::size_t pixels = image.rgba.size() / 4;
  out.rgb.resize(3 * pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * p + c] = image.rgba[4 * p + c];
  }
  return out;
}

}  // namespace sim
