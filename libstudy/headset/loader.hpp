#pragma once
/// The OpenXR loader, the connection to the runtime, and the runtime's clock. The loader is opened at run
/// time: programs also start on machines without it.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/display/cut_cause.hpp"
#include "libstudy/headset/openxr.hpp"
#include "stats/base/error.hpp"

namespace study {

/// Error: the session or the whole runtime is gone. Objects of a lost session or runtime can only be
/// destroyed.
class HeadsetLost final : public DisplayGone {
 public:
  HeadsetLost(const std::string& place, const std::string& problem, const std::string& mend,
              bool with_runtime)
      : DisplayGone(with_runtime ? CutCause::ServiceGone : CutCause::SessionLost, place, problem, mend),
        with_runtime_(with_runtime) {}
  /// True if the runtime is gone as well; false: a new session can be made.
  bool with_runtime() const { return with_runtime_; }

 private:
  bool with_runtime_;
};

/// Throws base::Error with the names of call and result if the result is a failure (negative), and
/// HeadsetLost if the session or the instance is lost. Codes >= 0 are successes.
void check_xr(XrResult result, const std::string& call,
              const std::string& mend = "restart the headset's software, and see its log");

/// Reads an array by OpenXR's two-call idiom: the first call returns the length, the second the values.
/// `fill`: (capacity, count, values) -> XrResult. `blank`: initial value of each element.
template <class T, class Fill>
std::vector<T> read_array(const std::string& call, const T& blank, Fill fill) {
  std::uint32_t count = 0;
  check_xr(fill(0u, &count, static_cast<T*>(nullptr)), call);
  std::vector<T> values;
  do {
    values.assign(count, blank);
    const XrResult result = fill(count, &count, values.data());
    if (result == XR_ERROR_SIZE_INSUFFICIENT) continue;  // the array grew between the calls
    check_xr(result, call);
    values.resize(count);
    return values;
  } while (true);
}

/// Names of the extensions that the active runtime offers. base::Error if there is no loader or no runtime.
std::vector<std::string> offered_extensions();

/// An OpenXR instance: the connection to the runtime. The destructor closes the connection.
class XrConnection {
 public:
  /// Connects and enables all `needed` extensions, and those of `wanted` that the runtime offers. base::Error
  /// if there is no loader or no runtime, or if a needed extension is not offered.
  XrConnection(const std::vector<std::string>& needed, const std::vector<std::string>& wanted);
  ~XrConnection();
  XrConnection(const XrConnection&) = delete;
  XrConnection& operator=(const XrConnection&) = delete;

  XrInstance instance() const { return instance_; }
  /// Call it if a call into the runtime does not return: the destructor then leaves the instance open.
  void leave_behind() { left_behind_ = true; }
  /// Names of all extensions that the runtime offers.
  const std::vector<std::string>& offered() const { return offered_; }
  /// True if the extension is enabled: requested and offered.
  bool has(const std::string& extension) const;

  /// Looks up a function of the runtime: function<PFN_xrGetSystem>("xrGetSystem"). base::Error if it is
  /// missing.
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

/// Converts the runtime's times to the session's clock, nanoseconds of CLOCK_MONOTONIC, by
/// XR_KHR_convert_timespec_time. Without this extension, the offset between the clocks is guessed once: the
/// first converted time becomes the current time, or earliest_ns if later.
class RuntimeClock {
 public:
  explicit RuntimeClock(const XrConnection& xr, std::int64_t earliest_ns = 0);
  bool converts() const { return converts_; }
  /// Returns the time on the session's clock, ns; -1 if the time is invalid for the runtime.
  std::int64_t to_ns(XrTime time);

 private:
  const XrConnection& xr_;
  bool converts_;
  bool guessed_ = false;
  std::int64_t earliest_ns_, ahead_ns_ = 0;
};

}  // namespace study
