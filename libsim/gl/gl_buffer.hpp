#pragma once
/// Buffers in the memory of the OpenGL device.

#include <cstdint>

#include "libsim/exec/gl_buffer_ref.hpp"

namespace sim {

/// A GL buffer, empty until reserve() allocates its memory; movable, not copyable. Needs a current context at
/// every call and when it is destroyed.
class GlBuffer {
 public:
  GlBuffer() = default;
  GlBuffer(GlBuffer&& other) noexcept;
  GlBuffer& operator=(GlBuffer&& other) noexcept;
  ~GlBuffer();
  /// Allocates at least `bytes`. If the buffer grows, its contents are lost and its GL name may change.
  void reserve(std::int64_t bytes);
  void write(const void* from, std::int64_t bytes);
  /// Sets every 32-bit word of the first `bytes` to `word`; of the whole buffer if `bytes` is negative.
  void fill(std::uint32_t word, std::int64_t bytes = -1);
  void read(void* out, std::int64_t bytes) const;
  unsigned name() const { return name_; }  ///< 0 before the first reserve
  GlBufferRef ref() const { return {name_, serial_, static_cast<std::size_t>(bytes_)}; }

 private:
  unsigned name_ = 0;
  std::uint64_t serial_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace sim
