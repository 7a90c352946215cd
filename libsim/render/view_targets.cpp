#include "libsim/render/view_targets.hpp"

#include <epoxy/gl.h>

#include <algorithm>

namespace sim {

namespace {

constexpr std::int64_t list_header_words = 12;  // before items[] in wide_list.glsl

}  // namespace

void ViewTargets::resize(const View& new_view, int thickness_step, bool with_foam) {
  view = new_view;
  const bool same_size = width == view.viewport.width && height == view.viewport.height;
  if (same_size) return;
  width = view.viewport.width;
  height = view.viewport.height;
  cells_x = (width + thickness_step - 1) / thickness_step;
  cells_y = (height + thickness_step - 1) / thickness_step;
  const std::int64_t pixels = std::int64_t{width} * height;
  const std::int64_t cells = std::int64_t{cells_x} * cells_y;
  block.reserve(512);
  for (GlBuffer* buffer : {&depth, &front, &radii, &filter_a, &filter_b, &shown, &outlines})
    buffer->reserve(4 * pixels);
  normals.reserve(16 * pixels);
  shaded.reserve(8 * pixels);
  blocks.reserve(4 * std::int64_t{(width + 15) / 16} * ((height + 15) / 16));
  for (GlBuffer* buffer : {&thickness, &thickness_a, &thickness_b}) buffer->reserve(4 * cells);
  if (with_foam) {
    foam.reserve(8 * pixels);
    foam.fill(0);
  }
  const std::int64_t tile_count = std::int64_t{(width + 15) / 16} * ((height + 7) / 8);
  outline_tiles.reserve(4 * (4 + tile_count));
  tiles.reserve(4 * (8 + tile_count));
  wet.reserve(4 * tile_count);
  wet.fill(1);  // all tiles count as wet, so that the next draw clears them
}

void ViewTargets::follow(std::int64_t count) {
  if (count <= room_) return;
  room_ = count + count / 4;
  touched.reserve(4 * room_);
  wide_list.reserve(4 * (list_header_words + 2 * room_));
}

void ViewTargets::read_depth(std::vector<float>& out) const {
  out.resize(pixels());
  depth.read(out.data(), static_cast<std::int64_t>(4 * out.size()));
}

void ViewTargets::read_picture(float radius_scale, GBuffer& out) const {
  out.width = width;
  out.height = height;
  out.view = view;
  out.radius_scale = radius_scale;
  for (auto* unread : {&out.filtered_depth, &out.thickness, &out.radius}) unread->clear();
  out.front.clear();
  read_depth(out.depth);
  // Normal and radius of a pixel are adjacent; the radii are removed in place.
  out.normal.resize(4 * pixels());
  normals.read(out.normal.data(), static_cast<std::int64_t>(16 * pixels()));
  for (std::size_t p = 1; p < pixels(); ++p) std::copy_n(&out.normal[4 * p], 3, &out.normal[3 * p]);
  out.normal.resize(3 * pixels());
}

GBuffer ViewTargets::read_gbuffer(float radius_scale, const RenderOptions& options) const {
  GBuffer g;
  read_picture(radius_scale, g);
  const auto fetch = [](const GlBuffer& buffer, auto& out, std::size_t count) {
    out.resize(count);
    buffer.read(out.data(), static_cast<std::int64_t>(4 * count));
  };
  fetch(filter_a, g.filtered_depth, pixels());
  for (float& nearness : g.filtered_depth) nearness = 1 / nearness;  // infinity without water
  fetch(front, g.front, pixels());
  std::vector<float> with_radii;
  std::vector<std::uint32_t> cells;
  fetch(normals, with_radii, 4 * pixels());
  fetch(thickness, cells, static_cast<std::size_t>(cells_x) * static_cast<std::size_t>(cells_y));
  g.radius.resize(pixels());
  g.thickness.resize(pixels());
  const auto step = static_cast<std::size_t>(options.thickness_step);
  for (std::size_t p = 0; p < pixels(); ++p) {
    g.radius[p] = with_radii[4 * p + 3];
    const std::size_t x = p % static_cast<std::size_t>(width), y = p / static_cast<std::size_t>(width);
    const std::uint32_t units = cells[y / step * static_cast<std::size_t>(cells_x) + x / step];
    g.thickness[p] = static_cast<float>(units) * options.thickness_unit_m;
  }
  return g;
}

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
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // orders the stores after earlier draws and reads
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
