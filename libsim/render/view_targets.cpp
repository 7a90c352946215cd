#include "libsim/render/view_targets.hpp"

#include <epoxy/gl.h>

#include <utility>

namespace sim {

GlBuffer::GlBuffer(GlBuffer&& other) noexcept
    : name_(std::exchange(other.name_, 0)), bytes_(std::exchange(other.bytes_, 0)) {}

GlBuffer& GlBuffer::operator=(GlBuffer&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

GlBuffer::~GlBuffer() {
  if (name_) glDeleteBuffers(1, &name_);
}

void GlBuffer::reserve(std::int64_t bytes) {
  if (name_ && bytes <= bytes_) return;
  if (name_) glDeleteBuffers(1, &name_);
  bytes_ = bytes < 16 ? 16 : bytes;
  glCreateBuffers(1, &name_);
  glNamedBufferStorage(name_, static_cast<GLsizeiptr>(bytes_), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

void GlBuffer::fill(std::uint32_t word, std::int64_t bytes) {
  glClearNamedBufferSubData(name_, GL_R32UI, 0, static_cast<GLsizeiptr>(bytes < 0 ? bytes_ : bytes),
                            GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

void GlBuffer::read(void* out, std::int64_t bytes) const {
  glGetNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes), out);
}

void ViewTargets::resize(const View& new_view, int thickness_step) {
  view = new_view;
  width = view.viewport.width;
  height = view.viewport.height;
  cells_x = (width + thickness_step - 1) / thickness_step;
  cells_y = (height + thickness_step - 1) / thickness_step;
  const std::int64_t pixels = std::int64_t{width} * height;
  const std::int64_t cells = std::int64_t{cells_x} * cells_y;
  block.reserve(512);
  for (GlBuffer* buffer : {&depth, &front, &filter_a, &filter_b}) buffer->reserve(4 * pixels);
  normals.reserve(16 * pixels);
  blocks.reserve(4 * std::int64_t{(width + 15) / 16} * ((height + 15) / 16));
  for (GlBuffer* buffer : {&thickness, &thickness_a, &thickness_b}) buffer->reserve(4 * cells);
}

void ViewTargets::follow(std::int64_t count) {
  if (count == followed_) return;
  touched.reserve(4 * count);
  touched.fill(0);
  followed_ = count;
}

}  // namespace sim
