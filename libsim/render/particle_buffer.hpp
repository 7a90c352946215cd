#pragma once
/// Particles as the renderer's input: a GL shader storage buffer of RenderParticle (x, y, z, radius in m).

#include <cstdint>
#include <span>

#include "libsim/particles/particle_state.hpp"
#include "libsim/render/gl_buffer.hpp"

namespace sim {

/// Needs a current context at every call and when it is destroyed.
class ParticleBuffer {
 public:
  /// Replaces the contents; grows the buffer if needed.
  void upload(std::span<const RenderParticle> particles);

  /// For writers on the device (CUDA interop): allocates `capacity` particles; then gl() may be registered.
  /// It stays the same until reserve() or upload() needs more than capacity(). The old contents are lost if
  /// it grows.
  void reserve(std::int64_t capacity);
  /// Sets the number of particles that a writer on the device has stored, at most capacity() (base::Error).
  void set_count(std::int64_t count);

  unsigned gl_name() const { return buffer_.name(); }  ///< 0 before the first reserve or upload
  GlBufferRef gl() const { return buffer_.ref(); }
  std::int64_t count() const { return count_; }
  std::int64_t capacity() const { return capacity_; }

 private:
  GlBuffer buffer_;
  std::int64_t count_ = 0;
  std::int64_t capacity_ = 0;
};

}  // namespace sim
