/// Images of the frames: as files, and as hashes in the log.

#include <png.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

/// RGBA, 8 bits per channel, sRGB; row 0 is the top.
struct Picture {
  std::uint32_t width, height;
  std::vector<std::uint8_t> rgba;
};

std::uint8_t encode(float linear) {
  const float x = std::fmin(std::fmax(linear, 0.0f), 1.0f);
  const float y = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * y));
}

/// RGBA values of the part's rectangle, rows from the bottom up, in the texture's encoding. Only sRGB
/// textures are not linear.
template <class T>
std::vector<T> read_texture(const XrSwapchainSubImage& part, GLenum type) {
  const Swapchain& swapchain = runtime().swapchains.at(number_of(part.swapchain));
  const auto& [offset, extent] = part.imageRect;
  std::vector<T> out(std::size_t{4} * extent.width * extent.height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureSubImage(swapchain.images.at(swapchain.shown), 0, offset.x, offset.y,
                       static_cast<GLint>(part.imageArrayIndex), extent.width, extent.height, 1, GL_RGBA,
                       type, static_cast<GLsizei>(out.size() * sizeof(T)), out.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  return out;
}

Picture read_picture(const XrSwapchainSubImage& part) {
  const Swapchain& swapchain = runtime().swapchains.at(number_of(part.swapchain));
  const auto& extent = part.imageRect.extent;
  Picture out{static_cast<std::uint32_t>(extent.width), static_cast<std::uint32_t>(extent.height), {}};
  std::vector<std::uint8_t> rows;
  if (swapchain.info.format == GL_SRGB8_ALPHA8) {
    rows = read_texture<std::uint8_t>(part, GL_UNSIGNED_BYTE);
  } else {
    const std::vector<float> light = read_texture<float>(part, GL_FLOAT);
    for (std::size_t i = 0; i < light.size(); ++i)
      rows.push_back(i % 4 == 3 ? static_cast<std::uint8_t>(std::lround(255 * light[i])) : encode(light[i]));
  }
  const std::size_t row = std::size_t{4} * out.width;
  for (std::size_t y = out.height; y-- > 0;)
    out.rgba.insert(out.rgba.end(), rows.begin() + y * row, rows.begin() + (y + 1) * row);
  return out;
}

/// The 64-bit FNV-1a hash of the picture's bytes.
std::uint64_t hash_of(const Picture& picture) {
  std::uint64_t hash = 14695981039346656037u;
  for (const std::uint8_t byte : picture.rgba) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

void write(const Picture& picture, const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = PNG_FORMAT_RGBA;
  if (!png_image_write_to_file(&image, path.c_str(), 0, picture.rgba.data(), 0, nullptr))
    log_line("cannot write " + path);
}

}  // namespace

std::string look_at(const std::vector<Shown>& images, long frame) {
  const Profile& profile = runtime().profile;
  const char* folder = std::getenv("VIP_XR_DUMP");
  const auto& dumps = profile.dumps;
  const bool dump = folder && std::find(dumps.begin(), dumps.end(), frame) != dumps.end();
  if (!dump && !profile.hash) return "";
  std::string text = " | shows";
  for (const Shown& shown : images) {
    const Picture picture = read_picture(*shown.part);
    char number[32];
    std::snprintf(number, sizeof number, "%016llx", static_cast<unsigned long long>(hash_of(picture)));
    text += " " + shown.name + " " + number;
    std::snprintf(number, sizeof number, "/%06ld_", frame);
    if (dump) write(picture, folder + std::string(number) + shown.name + ".png");
  }
  return text;
}

}  // namespace simulated
