#include "libstudy/headset/loader.hpp"

#include <dlfcn.h>
#include <openxr/openxr_reflection.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "libstudy/base/clock.hpp"

namespace study {

namespace {

std::string name_of(XrResult result) {
  switch (result) {
#define APPS_XR_NAME(name, value) \
  case name:                      \
    return #name;
    XR_LIST_ENUM_XrResult(APPS_XR_NAME)
#undef APPS_XR_NAME
            default : return "XrResult " +
                      std::to_string(static_cast<int>(result));
  }
}

/// Opens the OpenXR loader: $VIP_OPENXR_LOADER, or the system's if the variable is unset or empty. The
/// library is never closed, because runtimes may leave running threads behind.
PFN_xrGetInstanceProcAddr open_loader() {
  const char* other = std::getenv("VIP_OPENXR_LOADER");
  const std::string library = other && *other ? other : "libopenxr_loader.so.1";
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    throw base::Error("OpenXR loader", "there is no " + library + " on this machine, or it cannot be loaded",
                      "install libopenxr-loader1, or name the loader in VIP_OPENXR_LOADER");
  }
  void* symbol = dlsym(handle, "xrGetInstanceProcAddr");
  if (!symbol) {
    throw base::Error("OpenXR loader", library + " is no OpenXR loader",
                      "name another one in VIP_OPENXR_LOADER");
  }
  return reinterpret_cast<PFN_xrGetInstanceProcAddr>(symbol);
}

constexpr const char* runtime_mend =
    "start the headset's software (Monado, SteamVR, WiVRn ...) and make it the active runtime, or name its "
    "file "
    "in XR_RUNTIME_JSON";

bool lists_word(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

void check_xr(XrResult result, const std::string& call, const std::string& mend) {
  if (result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST) {
    throw HeadsetLost("OpenXR, " + call, name_of(result),
                      "check that the headset and its software run; vip-study resume continues a session",
                      result == XR_ERROR_INSTANCE_LOST);
  }
  if (XR_FAILED(result)) throw base::Error("OpenXR, " + call, name_of(result), mend);
}

std::vector<std::string> offered_extensions() {
  PFN_xrVoidFunction found = nullptr;
  constexpr const char* call = "xrEnumerateInstanceExtensionProperties";
  check_xr(open_loader()(XR_NULL_HANDLE, call, &found), call, runtime_mend);
  const auto list = reinterpret_cast<PFN_xrEnumerateInstanceExtensionProperties>(found);
  std::uint32_t count = 0;
  if (const XrResult result = list(nullptr, 0, &count, nullptr); XR_FAILED(result)) {
    throw base::Error("OpenXR", "no runtime answers (" + name_of(result) + ")", runtime_mend);
  }
  XrExtensionProperties blank{};
  blank.type = XR_TYPE_EXTENSION_PROPERTIES;
  std::vector<std::string> out;
  for (const auto& one : read_array<XrExtensionProperties>(
           call, blank,
           [&](auto capacity, auto*size, auto*values) { return list(nullptr, capacity, size, values); }))
    out.emplace_back(one.extensionName);
  return out;
}

XrConnection::XrConnection(const std::vector<std::string>& needed, const std::vector<std::string>& wanted)
    : get_(open_loader()), offered_(offered_extensions()) {
  for (const std::string& name : needed) {
    if (!lists_word(offered_, name))
      throw base::Error("OpenXR", "the runtime does not offer " + name,
                        "make another OpenXR runtime the active one, such as Monado or SteamVR");
    enabled_.push_back(name);
  }
  for (const std::string& name : wanted) {
    if (lists_word(offered_, name)) enabled_.push_back(name);
  }
  std::vector<const char*> names;
  for (const std::string& name : enabled_) names.push_back(name.c_str());
  XrInstanceCreateInfo info{};
  info.type = XR_TYPE_INSTANCE_CREATE_INFO;
  std::strncpy(info.applicationInfo.applicationName, "ViP-Lab", XR_MAX_APPLICATION_NAME_SIZE - 1);
  info.applicationInfo.apiVersion = XR_CURRENT_API_VERSION;
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.enabledExtensionNames = names.data();
  check_xr(function<PFN_xrCreateInstance>("xrCreateInstance")(&info, &instance_), "xrCreateInstance",
           runtime_mend);
}

XrConnection::~XrConnection() {
  if (instance_ != XR_NULL_HANDLE && !left_behind_)
    function<PFN_xrDestroyInstance>("xrDestroyInstance")(instance_);
}

bool XrConnection::has(const std::string& extension) const { return lists_word(enabled_, extension); }

PFN_xrVoidFunction XrConnection::find(const char* name) const {
  PFN_xrVoidFunction found = nullptr;
  check_xr(get_(instance_, name, &found), std::string("xrGetInstanceProcAddr ") + name, "update the runtime");
  return found;
}

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
