#pragma once
/// The OpenXR loader, opened at run time, so that programs start on machines without it; the connection to
/// the runtime, and the runtime's clock.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/headset/openxr.hpp"
#include "stats/base/error.hpp"

namespace study {

/// The session or the whole runtime is gone; objects made from it can only be destroyed.
class HeadsetLost final : public base::Error {
 public:
  HeadsetLost(const std::string& place, const std::string& problem, const std::string& mend,
              bool with_runtime)
      : base::Error(place, problem, mend), with_runtime_(with_runtime) {}
  /// False if another session can be made.
  bool with_runtime() const { return with_runtime_; }

 private:
  bool with_runtime_;
};

/// Throws base::Error naming the call and the result if the result is a failure; positive codes are
/// successes. HeadsetLost if the session or the instance is lost.
void check_xr(XrResult result, const std::string& call, const std::string& mend = "");

/// Reads an array by OpenXR's two-call idiom; the first call asks for its length. `fill`: (capacity, count,
/// values) -> XrResult.
template <class T, class Fill>
std::vector<T> read_array(const std::string& call, const T& blank, Fill fill) {
  std::uint32_t count = 0;
  check_xr(fill(0u, &count, static_cast<T*>(nullptr)), call);
  std::vector<T> values;
  do {
    values.assign(count, blank);
    const XrResult result = fill(count, &count, values.data());
    if (result == XR_ERROR_SIZE_INSUFFICIENT) continue;  // grown between the calls
    check_xr(result, call);
    values.resize(count);
    return values;
  } while (true);
}

/// Names of the active runtime's extensions. base::Error if there is no loader, or no runtime answers.
std::vector<std::string> offered_extensions();

/// One instance: the connection to the runtime. The destructor closes it.
class XrConnection {
 public:
  /// Connects with those of the wanted extensions that the runtime offers. base::Error if there is no loader,
  /// no runtime answers, or one of `needed` is not offered.
  XrConnection(const std::vector<std::string>& needed, const std::vector<std::string>& wanted);
  ~XrConnection();
  XrConnection(const XrConnection&) = delete;
  XrConnection& operator=(const XrConnection&) = delete;

  XrInstance instance() const { return instance_; }
  /// For a call that never returned: the instance stays until the process ends.
  void leave_behind() { left_behind_ = true; }
  /// Names of all extensions that the runtime offers.
  const std::vector<std::string>& offered() const { return offered_; }
  /// True if the extension was asked for and offered.
  bool has(const std::string& extension) const;

  /// A function of the runtime: function<PFN_xrGetSystem>("xrGetSystem"). base::Error if it is missing.
  template <class F>
  F function(const char* name) const {
    return reinterpret_cast<F>(find(name));
  }

 private:
  PFN_xrVoidFunction find(const char* name) const;

  PFN_xrGetInstanceProcAddr get_ = nullptr;
  XrInstance instance_ = XR_NULL_HANDLE;
  std::vector<std::string> offered_, enabled_;
  bool left_behind_ = false;
};

/// Converts the runtime's times to the session's clock: nanoseconds of CLOCK_MONOTONIC, by
/// XR_KHR_convert_timespec_time. If this is not offered, the offset between the clocks is guessed once: the
/// first converted time is now, or earliest_ns if that is later.
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
