#include "libstudy/headset/runtime_clock.hpp"

#include <algorithm>

#include "libstudy/base/clock.hpp"

namespace study {

RuntimeClock::RuntimeClock(const XrConnection& xr, std::int64_t earliest_ns)
    : xr_(xr), converts_(xr.has(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME)), earliest_ns_(earliest_ns) {}

std::int64_t RuntimeClock::to_ns(XrTime time) {
  if (time <= 0) return -1;
  if (converts_) {
    timespec found{};
    const XrResult result = xr_.function<PFN_xrConvertTimeToTimespecTimeKHR>(
        "xrConvertTimeToTimespecTimeKHR")(xr_.instance(), time, &found);
    if (result == XR_ERROR_TIME_INVALID) return -1;
    check_xr(result, "xrConvertTimeToTimespecTimeKHR");
    return found.tv_sec * 1'000'000'000 + found.tv_nsec;
  }
  if (!guessed_) ahead_ns_ = time - std::max(RealClock().now_ns(), earliest_ns_);
  guessed_ = true;
  return time - ahead_ns_;
}

}  // namespace study
