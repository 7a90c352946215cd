#pragma once
/// GL buffers mapped into the back end's memory, if the back end supports it.

#include <utility>
#include <vector>

#include "libsim/exec/gl_buffer_ref.hpp"

namespace sim::SIM_BACKEND {

class GlSharing {
 public:
  enum class Access { Read, Overwrite };

  explicit GlSharing(Access access) : access_(access) {}
  ~GlSharing();
  GlSharing(GlSharing&& other) noexcept : GlSharing(other.access_) { *this = std::move(other); }
  GlSharing& operator=(GlSharing&& other) noexcept {
    std::swap(access_, other.access_);
    buffers_.swap(other.buffers_);
    resources_.swap(other.resources_);
    memory_.swap(other.memory_);
    return *this;
  }

  /// Registers buffers of the current GL context after releasing the buffers of the last call; does nothing
  /// if both lists are equal. False if a buffer cannot be shared: the back end is the CPU, or GL runs on
  /// another device.
  bool accept(const std::vector<GlBufferRef>& buffers);
  /// The accepted buffers as memory, in the same order, until unmap(). Mapping twice has no further effect.
  /// Earlier GL commands finish first, and GL waits for work launched meanwhile. Each switch between GL and
  /// the back end took 0.16 to 0.31 ms on an H200 (docs/decisions.md): map once per frame, and unmap where GL
  /// continues anyway.
  const std::vector<void*>& map();
  /// Returns the buffers to GL; does nothing if they are not mapped.
  void unmap();
  /// Maps the accepted buffers again, if any.
  void map_again() {
    if (!resources_.empty()) map();
  }

 private:
  void forget();

  Access access_;
  std::vector<GlBufferRef> buffers_;
  std::vector<void*> resources_;  ///< handles, one per buffer; empty if the buffers cannot be shared
  std::vector<void*> memory_;     ///< address of each buffer while mapped
};

}  // namespace sim::SIM_BACKEND
