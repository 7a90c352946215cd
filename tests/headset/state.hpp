#pragma once
/// A simulated OpenXR runtime for tests, loaded by the real loader through XR_RUNTIME_JSON.
///
/// VIP_XR_PROFILE says what it offers, as "key=value;key=value" (profile.cpp lists the keys). VIP_XR_LOG
/// names a file to which each call is appended, and each breach of the specification by its caller as a line
/// "BREACH ...".

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "apps/common/headset/openxr.hpp"

namespace simulated {

/// What the headset and the runtime are like.
struct Profile {
  std::string runtime_name = "Simulated runtime";
  std::string headset_name = "Simulated headset";
  std::string headset = "connected";  ///< "connected", "unavailable" or "unsupported"
  std::uint32_t width = 2064, height = 2208;
  std::vector<std::string> extensions;
  std::vector<float> rates{72, 80, 90, 120};  ///< Hz, in the order in which they are told
  float rate = 90;                            ///< Hz, now
  std::vector<std::int64_t> formats;          ///< GL internal formats, the preferred one first
  bool gaze = true;                           ///< supportsEyeGazeInteraction
  bool position = true;                       ///< positionTracking
  bool opaque = true;                         ///< blend mode offered beside additive
  bool stereo = true;
  bool positive = false;  ///< calls that may succeed with a positive code do
};

/// Reads VIP_XR_PROFILE; std::invalid_argument for a key or value that is not known.
Profile read_profile();

/// Everything of one process.
struct Runtime {
  Profile profile;
  std::set<std::string> enabled;  ///< extensions of the instance
  std::set<std::uint64_t> instances, sessions;
  std::uint64_t next_handle = 1;
  bool asked_graphics = false;  ///< xrGetOpenGLGraphicsRequirementsKHR was called
  bool asked_system = false;
};
Runtime& runtime();

/// Appends a line to the log.
void log_line(const std::string& text);
/// The caller broke the specification.
void breach(const std::string& text);

constexpr XrSystemId the_system = 7;

template <class Handle>
std::uint64_t number_of(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}
/// A handle that was never given before.
template <class Handle>
Handle new_handle(std::set<std::uint64_t>& living) {
  const std::uint64_t number = runtime().next_handle++ << 4;
  living.insert(number);
  return reinterpret_cast<Handle>(number);
}

/// XR_SUCCESS when a call's handle lives.
XrResult check_instance(XrInstance instance, const char* call);
XrResult check_session(XrSession session, const char* call);
XrResult check_system(XrInstance instance, XrSystemId system, const char* call);
/// XR_SUCCESS when a structure says that it is what it should be.
template <class T>
XrResult check_type(const T* structure, XrStructureType type, const char* call) {
  if (structure && structure->type == type) return XR_SUCCESS;
  breach(std::string(call) + ": a structure of another type, or none");
  return XR_ERROR_VALIDATION_FAILURE;
}
/// The same for an extension's function.
XrResult check_enabled(const char* extension, const char* call);

/// Gives an array by OpenXR's two calls.
template <class T, class Write>
XrResult give_array(const std::vector<T>& values, std::uint32_t capacity, std::uint32_t* count, Write write,
                    const char* call) {
  if (!count) {
    breach(std::string(call) + ": no place for the count");
    return XR_ERROR_VALIDATION_FAILURE;
  }
  *count = static_cast<std::uint32_t>(values.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const XrResult result = write(i, values[i]); result != XR_SUCCESS) return result;
  }
  return XR_SUCCESS;
}
template <class T>
XrResult give_values(const std::vector<T>& values, std::uint32_t capacity, std::uint32_t* count, T* out,
                     const char* call) {
  return give_array(
      values, capacity, count,
      [&](std::size_t i, const T& value) {
        out[i] = value;
        return XR_SUCCESS;
      },
      call);
}

/// The functions of the tables below by name.
using Functions = std::map<std::string, PFN_xrVoidFunction>;
template <class F>
PFN_xrVoidFunction as_void(F function) {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}
void add_instance_functions(Functions& functions);
void add_session_functions(Functions& functions);

}  // namespace simulated
