#pragma once
/// Converts the runtime's times to the session's clock.

#include <cstdint>

#include "libstudy/headset/loader.hpp"

namespace study {

/// Nanoseconds of CLOCK_MONOTONIC, by XR_KHR_convert_timespec_time. If this is not offered, the offset
/// between the clocks is guessed once: the first converted time is now, or earliest_ns if that is later.
class RuntimeClock {
 public:
  explicit RuntimeClock(const XrConnection& xr, std::int64_t earliest_ns = 0);
  bool converts() const { return converts_; }
  /// -1 for a time that the runtime itself does not know.
  std::int64_t to_ns(XrTime time);

 private:
  const XrConnection& xr_;
  bool converts_;
  bool guessed_ = false;
  std::int64_t earliest_ns_, ahead_ns_ = 0;
};

}  // namespace study
