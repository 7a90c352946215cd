#include "libsim/gl/gl_buffer.hpp"

#include <epoxy/gl.h>

#include <atomic>
#include <utility>

namespace sim {

namespace {

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

GlBuffer::GlBuffer(GlBuffer&& other) noexcept
    : name_(std::exchange(other.name_, 0)), serial_(other.serial_), bytes_(std::exchange(other.bytes_, 0)) {}

GlBuffer& GlBuffer::operator=(GlBuffer&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(serial_, other.serial_);
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
  serial_ = next_serial();
  glCreateBuffers(1, &name_);
  glNamedBufferStorage(name_, static_cast<GLsizeiptr>(bytes_), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

void GlBuffer::write(const void* from, std::int64_t bytes) {
  glNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes), from);
}

void GlBuffer::fill(std::uint32_t word, std::int64_t bytes) {
  glClearNamedBufferSubData(name_, GL_R32UI, 0, static_cast<GLsizeiptr>(bytes < 0 ? bytes_ : bytes),
                            GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

void GlBuffer::read(void* out, std::int64_t bytes) const {
  glGetNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes), out);
}

}  // namespace sim
