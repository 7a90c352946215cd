#include "libsim/render/picture_target.hpp"

#include <epoxy/gl.h>

#include <algorithm>

namespace sim {

namespace {

GLint attachment(unsigned framebuffer, GLenum what) {
  GLint value = 0;
  glGetNamedFramebufferAttachmentParameteriv(framebuffer, GL_COLOR_ATTACHMENT0, what, &value);
  return value;
}

/// The RGBA8 texture that is a framebuffer's colour; 0 for any other colour attachment.
GLuint storable_texture(unsigned framebuffer) {
  if (framebuffer == 0 || attachment(framebuffer, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_TEXTURE ||
      attachment(framebuffer, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL) != 0)
    return 0;
  const auto texture = static_cast<GLuint>(attachment(framebuffer, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME));
  GLint format = 0, target = 0;
  glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
  glGetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
  return format == GL_RGBA8 && target == GL_TEXTURE_2D ? texture : 0;
}

}  // namespace

void PictureTarget::begin(unsigned framebuffer, std::span<const View> views) {
  GLuint texture = storable_texture(framebuffer);
  copies_ = texture == 0;
  if (copies_) {
    int width = 1, height = 1;
    for (const View& view : views) {
      width = std::max(width, view.viewport.x + view.viewport.width);
      height = std::max(height, view.viewport.y + view.viewport.height);
    }
    if (!own_ || own_->width() != width || own_->height() != height)
      own_ = std::make_unique<Offscreen>(width, height);
    texture = own_->texture();
  }
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // after earlier draws and reads
  glBindImageTexture(0, texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
}

void PictureTarget::end(unsigned framebuffer, std::span<const View> views) const {
  glBindImageTexture(0, 0, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
  if (!copies_) return;
  for (const View& view : views) {
    const Viewport& v = view.viewport;
    glBlitNamedFramebuffer(own_->framebuffer(), framebuffer, v.x, v.y, v.x + v.width, v.y + v.height, v.x,
                           v.y, v.x + v.width, v.y + v.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
}

}  // namespace sim
