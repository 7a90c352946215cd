#pragma once
/// Wrapper around the runtime's OpenXR functions. It runs one call at a time, logs it, and turns the
/// exception Refusal into the call's result.

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tests/headset/openxr.hpp"

namespace simulated {

/// The mutex that is locked during every call. xrWaitFrame unlocks it while it waits.
std::mutex& lock();
/// Name of the OpenXR function that is running on this thread.
const char*& current_call();

/// Appends a line to the file that VIP_XR_LOG names. Without this variable nothing is logged.
void log_line(const std::string& text);
/// Logs that the caller broke the specification.
void breach(const std::string& text);
/// Logs something that the specification allows but that is probably a mistake.
void note(const std::string& text);

/// Exception that ends a call with this result.
struct Refusal {
  XrResult result;
};
/// Ends the call with a failure that is not the caller's fault.
[[noreturn]] inline void fail(XrResult result) { throw Refusal{result}; }
/// Logs the caller's fault and ends the call with the failure that the specification names for it.
[[noreturn]] inline void refuse(XrResult result, const std::string& text) {
  breach(text);
  fail(result);
}
inline void need(bool kept, XrResult result, const std::string& text) {
  if (!kept) refuse(result, text);
}

/// The functions of the runtime by name.
using Functions = std::map<std::string, PFN_xrVoidFunction>;

template <std::size_t n>
struct Name {
  constexpr Name(const char (&name)[n]) { std::copy_n(name, n, text); }
  char text[n];
};
/// Whether each call has a line in the log. Calls that a program makes every frame have none: xrEndFrame
/// writes one line for the whole frame.
enum class Logged { each_call, frame_line };

template <Name name, Logged logged, auto function>
struct Entry;
template <Name name, Logged logged, class... Arguments, XrResult (*function)(Arguments...)>
struct Entry<name, logged, function> {
  static XRAPI_ATTR XrResult XRAPI_CALL call(Arguments... arguments) {
    const std::lock_guard held(lock());
    current_call() = name.text;
    if (logged == Logged::each_call) log_line(name.text);
    try {
      return function(arguments...);
    } catch (const Refusal& refusal) {
      return refusal.result;
    }
  }
};

template <Name name, auto function, Logged logged = Logged::each_call>
void add(Functions& functions) {
  functions[name.text] = reinterpret_cast<PFN_xrVoidFunction>(Entry<name, logged, function>::call);
}

/// Refuses a structure that is null or has another type.
template <class T>
void need_type(const T* structure, XrStructureType type) {
  need(structure && structure->type == type, XR_ERROR_VALIDATION_FAILURE,
       "a structure of another type, or none");
}
/// Refuses a structure of another type; null is allowed.
template <class T>
void need_type_or_null(const T* structure, XrStructureType type) {
  if (structure) need_type(structure, type);
}
/// The structure of this type in the chain that begins at `next`, or null.
template <class T>
T* find_chained(const void* next, XrStructureType type) {
  for (auto* one = static_cast<const XrBaseInStructure*>(next); one; one = one->next) {
    if (one->type == type) return reinterpret_cast<T*>(const_cast<XrBaseInStructure*>(one));
  }
  return nullptr;
}

/// Refuses a chain with a structure of an extension that is not enabled.
void need_chain(const void* next);

/// Returns an array by OpenXR's two-call idiom: calls write(index, value) for each value.
template <class T, class Write>
XrResult give_array(const std::vector<T>& values, std::uint32_t capacity, std::uint32_t* count, Write write) {
  need(count, XR_ERROR_VALIDATION_FAILURE, "no place for the count");
  *count = static_cast<std::uint32_t>(values.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < values.size(); ++i) write(i, values[i]);
  return XR_SUCCESS;
}
template <class T>
XrResult give_values(const std::vector<T>& values, std::uint32_t capacity, std::uint32_t* count, T* out) {
  return give_array(values, capacity, count, [&](std::size_t i, const T& value) { out[i] = value; });
}

}  // namespace simulated
