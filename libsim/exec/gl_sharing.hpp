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
    return *this;
  }

  /// Registers buffers of the current context in place of those before, unless they are the same. False when
  /// one cannot be shared: the back end is the CPU, or GL runs on another device.
  bool accept(const std::vector<GlBufferRef>& buffers);
  /// What was accepted as memory, in the same order, until unmap(). What GL was told before comes first, and
  /// GL waits for what is launched meanwhile.
  std::vector<void*> map();
  void unmap();

 private:
  void forget();

  Access access_;
  std::vector<GlBufferRef> buffers_;
  std::vector<void*> resources_;  ///< one a buffer; none when they were refused
};

}  // namespace sim::SIM_BACKEND
