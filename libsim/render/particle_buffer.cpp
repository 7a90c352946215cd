#include "libsim/render/particle_buffer.hpp"

#include "stats/base/error.hpp"

namespace sim {

static_assert(sizeof(RenderParticle) == 16, "the shaders read a particle as one vec4");

void ParticleBuffer::upload(std::span<const RenderParticle> particles) {
  const auto count = static_cast<std::int64_t>(particles.size());
  reserve(count);
  if (count > 0) buffer_.write(particles.data(), static_cast<std::int64_t>(particles.size_bytes()));
  count_ = count;
}

void ParticleBuffer::reserve(std::int64_t capacity) {
  if (gl_name() && capacity <= capacity_) return;
  capacity_ = capacity < 1 ? 1 : capacity;
  count_ = 0;
  buffer_.reserve(capacity_ * 16);
}

void ParticleBuffer::set_count(std::int64_t count) {
  if (count < 0 || count > capacity_) {
    throw base::Error("particle buffer", "a count beyond the buffer's capacity",
                      "reserve() before set_count()");
  }
  count_ = count;
}

}  // namespace sim
