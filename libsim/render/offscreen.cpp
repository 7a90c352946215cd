#include "libsim/render/offscreen.hpp"

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

Image Offscreen::read() const { return read_framebuffer(framebuffer_, width_, height_); }

Image read_framebuffer(unsigned framebuffer, int width, int height) {
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(width);
  Image image{width, height, std::vector<std::uint8_t>(row_bytes * static_cast<std::size_t>(height))};
  GLint previous = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &previous);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(previous));
  // GL counts rows from the bottom.
  for (int low = 0, high = height - 1; low < high; ++low, --high) {
    std::swap_ranges(image.rgba.begin() + static_cast<std::ptrdiff_t>(row_bytes) * low,
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(row_bytes) * (low + 1),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(row_bytes) * high);
  }
  return image;
}

}  // namespace sim
