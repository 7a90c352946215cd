#pragma once
/// The OpenXR loader, opened at run time: programs start on machines that have none.

#include <string>
#include <vector>

#include "apps/common/headset/openxr.hpp"
#include "stats/base/error.hpp"

namespace apps {

/// The session or the whole runtime is gone; what was made of it can only be destroyed.
class HeadsetLost final : public base::Error {
 public:
  HeadsetLost(const std::string& place, const std::string& problem, const std::string& mend,
              bool with_runtime)
      : base::Error(place, problem, mend), with_runtime_(with_runtime) {}
  /// Else another session can be made.
  bool with_runtime() const { return with_runtime_; }

 private:
  bool with_runtime_;
};

/// base::Error that names the call and the result, unless the result is a success: positive codes are none of
/// failures. HeadsetLost for a session or an instance that is lost.
void check_xr(XrResult result, const std::string& call, const std::string& mend = "");

/// An array by OpenXR's two calls, the first of which asks for its length. `fill`: (capacity, count, values)
/// -> XrResult.
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

/// What the active runtime offers, by name. base::Error when there is no loader, or no runtime that answers.
std::vector<std::string> offered_extensions();

/// One instance: the connection to the runtime. Closed with the object.
class XrConnection {
 public:
  /// Connects with those of the wanted extensions that the runtime offers. base::Error when there is no
  /// loader, no runtime that answers, or one of `needed` is not offered.
  XrConnection(const std::vector<std::string>& needed, const std::vector<std::string>& wanted);
  ~XrConnection();
  XrConnection(const XrConnection&) = delete;
  XrConnection& operator=(const XrConnection&) = delete;

  XrInstance instance() const { return instance_; }
  /// A call never came back: the instance stays until the process ends.
  void leave_behind() { left_behind_ = true; }
  /// Everything that the runtime offers, by name.
  const std::vector<std::string>& offered() const { return offered_; }
  /// Whether an extension was asked for and offered.
  bool has(const std::string& extension) const;

  /// A function of the runtime: function<PFN_xrGetSystem>("xrGetSystem"). base::Error when it lacks it.
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

}  // namespace apps
