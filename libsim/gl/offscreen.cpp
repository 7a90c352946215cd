#include "libsim/gl/offscreen.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

#include "stats/base/error.hpp"

namespace sim {

Offscreen::Offscreen(int width, int height) : width_(width), height_(height) {
  GLint max_size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  if (width < 1 || height < 1 || width > max_size || height > max_size) {
    throw base::Error("picture of " + std::to_string(width) + " x " + std::to_string(height) + " px",
                      "the size is out of range", "use 1 to " + std::to_string(max_size) + " px a side");
  }
  glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
  glTextureStorage2D(texture_, 1, GL_RGBA8, width, height);
  glCreateFramebuffers(1, &framebuffer_);
  glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
}

Offscreen::~Offscreen() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

namespace {

Image black(int width, int height) {
  return {width, height,
          std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

/// Reverses the rows: GL starts with the bottom row, an Image with the top row.
Image from_the_top(Image image) {
  const auto row = [&](int y) { return image.rgba.begin() + std::ptrdiff_t{4} * image.width * y; };
  for (int low = 0, high = image.height - 1; low < high; ++low, --high)
    std::swap_ranges(row(low), row(low + 1), row(high));
  return image;
}

}  // namespace

/// Reads the texture, not the framebuffer: one driver took sixty times as long to read pixels through the
/// framebuffer if compute shaders had stored them (docs/decisions.md).
Image Offscreen::read() const {
  Image image = black(width_, height_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(texture_, 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.rgba.size()),
                    image.rgba.data());
  return from_the_top(std::move(image));
}

Image read_framebuffer(unsigned framebuffer, int width, int height) {
  Image image = black(width, height);
  GLint previous = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &previous);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(previous));
  return from_the_top(std::move(image));
}

}  // namespace sim
