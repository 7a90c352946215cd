/// The runtime's clock, and its conversion from and to timespec.

#include <cmath>
#include <thread>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

constexpr std::int64_t second = 1'000'000'000;

XrResult from_timespec(XrInstance instance, const timespec* from, XrTime* to) {
  need_instance(instance);
  need(from && to, XR_ERROR_VALIDATION_FAILURE, "no time, or no place for it");
  need(from->tv_nsec >= 0 && from->tv_nsec < second, XR_ERROR_TIME_INVALID, "a time of too many nanoseconds");
  *to = from->tv_sec * second + from->tv_nsec + ahead_of_monotonic;
  return XR_SUCCESS;
}

XrResult to_timespec(XrInstance instance, XrTime from, timespec* to) {
  need_instance(instance);
  need(from > 0, XR_ERROR_TIME_INVALID, "a time that is not positive");
  const XrTime monotonic = from - ahead_of_monotonic;
  if (monotonic < 0) return XR_ERROR_TIME_INVALID;
  *to = {monotonic / second, monotonic % second};
  return XR_SUCCESS;
}

}  // namespace

XrTime now() {
  const Clock& clock = runtime().clock;
  if (!clock.real) return clock.now;
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * second + time.tv_nsec + ahead_of_monotonic;
}

XrDuration period() { return std::llround(1e9 / static_cast<double>(runtime().profile.rate)); }

void wait_until(XrTime time) {
  Clock& clock = runtime().clock;
  if (!clock.real) {
    clock.now = std::max(clock.now, time);
    return;
  }
  const XrDuration left = time - now();
  if (left <= 0) return;
  lock().unlock();
  std::this_thread::sleep_for(std::chrono::nanoseconds(left));
  lock().lock();
}

void add_time_functions(Functions& functions) {
  if (!runtime().enabled.contains(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME)) return;
  add<"xrConvertTimespecTimeToTimeKHR", from_timespec, Logged::frame_line>(functions);
  add<"xrConvertTimeToTimespecTimeKHR", to_timespec, Logged::frame_line>(functions);
}

}  // namespace simulated
