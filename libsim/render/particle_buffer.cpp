#include "libsim/render/particle_buffer.hpp"

#include <epoxy/gl.h>

#include "stats/base/error.hpp"

namespace sim {

static_assert(sizeof(RenderParticle) == 16, "the shaders read a particle as one vec4");

ParticleBuffer::~ParticleBuffer() {
  if (name_) glDeleteBuffers(1, &name_);
}

void ParticleBuffer::upload(std::span<const RenderParticle> particles) {
  const auto count = static_cast<std::int64_t>(particles.size());
  reserve(count);
  if (count > 0)
    glNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(particles.size_bytes()), particles.data());
  count_ = count;
}

void ParticleBuffer::reserve(std::int64_t capacity) {
  if (name_ && capacity <= capacity_) return;
  if (name_) glDeleteBuffers(1, &name_);
  capacity_ = capacity < 1 ? 1 : capacity;
  count_ = 0;
  glCreateBuffers(1, &name_);
  glNamedBufferData(name_, static_cast<GLsizeiptr>(capacity_ * 16), nullptr, GL_DYNAMIC_DRAW);
}

void ParticleBuffer::set_count(std::int64_t count) {
  if (count < 0 || count > capacity_) {
    throw base::Error("particle buffer", "a count beyond the buffer's capacity",
                      "reserve() before set_count()");
  }
  count_ = count;
}

}  // namespace sim
