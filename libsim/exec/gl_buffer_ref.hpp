#pragma once
/// Reference to an OpenGL buffer, for code that calls no OpenGL.

#include <cstddef>
#include <cstdint>

namespace sim {

struct GlBufferRef {
  unsigned name = 0;         ///< 0: none
  std::uint64_t serial = 0;  ///< distinguishes the buffer from a deleted one whose name GL reused
  std::size_t bytes = 0;

  friend bool operator==(const GlBufferRef&, const GlBufferRef&) = default;
};

}  // namespace sim
