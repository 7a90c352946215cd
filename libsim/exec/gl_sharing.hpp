#pragma once
/// A GL buffer seen as memory of the back end, where the back end can.

#include <cstddef>

namespace sim::SIM_BACKEND {

class GlSharing {
 public:
  GlSharing() = default;
  ~GlSharing();
  GlSharing(const GlSharing&) = delete;
  GlSharing& operator=(const GlSharing&) = delete;

  /// Registers the GL buffer of the current context at its first use and maps it. Null when it cannot be
  /// shared or holds fewer than `bytes`.
  void* map(unsigned buffer, std::size_t bytes);
  void unmap();

 private:
  void forget();

  void* resource_ = nullptr;
  unsigned buffer_ = 0;
  bool refused_ = false;
};

}  // namespace sim::SIM_BACKEND
