#pragma once
/// GL buffers seen as memory of the back end, where the back end can.

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

  /// Registers buffers of the current context in place of those before, unless they are the same. False when
  /// one cannot be shared: the back end is the CPU, or GL runs on another device.
  bool accept(const std::vector<GlBufferRef>& buffers);
  /// What was accepted as memory, in the same order, until unmap(); mapped twice is mapped once. What GL was
  /// told before comes first, and GL waits for what is launched meanwhile. Each change between GL and the
  /// back end takes the device a while (docs/performance.md): map once a frame, and unmap where GL goes on
  /// anyway.
  const std::vector<void*>& map();
  /// Gives them back to GL; nothing when they are not mapped.
  void unmap();
  /// Maps again what was accepted before, if anything was.
  void map_again() {
    if (!resources_.empty()) map();
  }

 private:
  void forget();

  Access access_;
  std::vector<GlBufferRef> buffers_;
  std::vector<void*> resources_;  ///< one a buffer; none when they were refused
  std::vector<void*> memory_;     ///< of each while they are mapped
};

}  // namespace sim::SIM_BACKEND
