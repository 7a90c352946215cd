#include "libstudy/headset/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "libstudy/headset/actions.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

XrSystemId find_system(const XrConnection& xr) {
  XrSystemGetInfo info{};
  info.type = XR_TYPE_SYSTEM_GET_INFO;
  info.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  const XrResult result = xr.function<PFN_xrGetSystem>("xrGetSystem")(xr.instance(), &info, &system);
  if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE) {
    throw base::Error("OpenXR", "the runtime answers, and no headset is connected to it",
                      "connect the headset, switch it on, and try again");
  }
  if (result == XR_ERROR_FORM_FACTOR_UNSUPPORTED) {
    throw base::Error("OpenXR", "the runtime does not support headsets",
                      "make a runtime for head-mounted displays the active one");
  }
  check_xr(result, "xrGetSystem");
  return system;
}

/// True if the headset reports whether it is worn. False also if the call fails: API layers that are older
/// than the extension refuse its structure.
bool reports_presence(const XrConnection& xr, XrSystemId system) {
  XrSystemUserPresencePropertiesEXT presence{};
  presence.type = XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT;
  XrSystemProperties found{};
  found.type = XR_TYPE_SYSTEM_PROPERTIES;
  found.next = &presence;
  const XrResult result =
      xr.function<PFN_xrGetSystemProperties>("xrGetSystemProperties")(xr.instance(), system, &found);
  return XR_SUCCEEDED(result) && presence.supportsUserPresence;
}

void read_properties(const XrConnection& xr, HeadsetSystem& out) {
  XrSystemEyeGazeInteractionPropertiesEXT gaze{};
  gaze.type = XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT;
  XrSystemProperties found{};
  found.type = XR_TYPE_SYSTEM_PROPERTIES;
  const bool asks_gaze = xr.has(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  if (asks_gaze) found.next = &gaze;
  check_xr(xr.function<PFN_xrGetSystemProperties>("xrGetSystemProperties")(xr.instance(), out.id, &found),
           "xrGetSystemProperties");
  out.name = found.systemName;
  out.position = found.trackingProperties.positionTracking;
  out.eye_gaze = asks_gaze && gaze.supportsEyeGazeInteraction;
  out.user_presence = xr.has(XR_EXT_USER_PRESENCE_EXTENSION_NAME) && reports_presence(xr, out.id);
}

void read_views(const XrConnection& xr, HeadsetSystem& out) {
  const auto list = xr.function<PFN_xrEnumerateViewConfigurations>("xrEnumerateViewConfigurations");
  const auto kinds = read_array<XrViewConfigurationType>(
      "xrEnumerateViewConfigurations", stereo_views, [&](auto capacity, auto* count, auto* values) {
        return list(xr.instance(), out.id, capacity, count, values);
      });
  if (std::find(kinds.begin(), kinds.end(), stereo_views) == kinds.end()) {
    throw base::Error("OpenXR", "the headset does not show a picture to each of two eyes",
                      "use a headset with two views");
  }
  XrViewConfigurationView blank{};
  blank.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  const auto views = xr.function<PFN_xrEnumerateViewConfigurationViews>("xrEnumerateViewConfigurationViews");
  out.views = read_array<XrViewConfigurationView>(
      "xrEnumerateViewConfigurationViews", blank, [&](auto capacity, auto* count, auto* values) {
        return views(xr.instance(), out.id, stereo_views, capacity, count, values);
      });
}

void read_blend_modes(const XrConnection& xr, HeadsetSystem& out) {
  const auto blends = xr.function<PFN_xrEnumerateEnvironmentBlendModes>("xrEnumerateEnvironmentBlendModes");
  const auto modes = read_array<XrEnvironmentBlendMode>(
      "xrEnumerateEnvironmentBlendModes", XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
      [&](auto capacity, auto* count, auto* values) {
        return blends(xr.instance(), out.id, stereo_views, capacity, count, values);
      });
  out.opaque = std::find(modes.begin(), modes.end(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE) != modes.end();
}

}  // namespace

sim::GlContext make_headset_context() {
  const auto offered = offered_extensions();
  const bool egl =
      std::find(offered.begin(), offered.end(), XR_MNDX_EGL_ENABLE_EXTENSION_NAME) != offered.end();
  const char* chosen = std::getenv("VIP_OPENXR_GRAPHICS");
  const std::string choice = chosen ? chosen : "";
  if (!choice.empty() && choice != "egl" && choice != "xlib")
    throw base::Error("VIP_OPENXR_GRAPHICS", "'" + choice + "' is not known",
                      "set it to egl or xlib, or unset it");
  if (choice == "egl" && !egl)
    throw base::Error("OpenXR", "the runtime does not offer " XR_MNDX_EGL_ENABLE_EXTENSION_NAME,
                      "unset VIP_OPENXR_GRAPHICS");
  if (egl && choice != "xlib") return sim::GlContext::make_headless();
  const char* display = std::getenv("DISPLAY");
  if (!display || !*display) {
    const std::string why = egl ? std::string("VIP_OPENXR_GRAPHICS asks for Xlib")
                                : "the runtime does not offer " XR_MNDX_EGL_ENABLE_EXTENSION_NAME;
    throw base::Error("OpenXR", why + ", and there is no X display",
                      "start the program on a desktop, or set DISPLAY");
  }
  return sim::GlContext::make_on_x();
}

XrConnection connect_to_headset(bool eye_gaze, bool user_presence) {
  std::vector<std::string> wanted{XR_MNDX_EGL_ENABLE_EXTENSION_NAME,
                                  XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME,
                                  XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME};
  const auto controllers = controller_extensions();
  wanted.insert(wanted.end(), controllers.begin(), controllers.end());
  if (eye_gaze) wanted.emplace_back(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  if (user_presence) wanted.emplace_back(XR_EXT_USER_PRESENCE_EXTENSION_NAME);
  return {{XR_KHR_OPENGL_ENABLE_EXTENSION_NAME}, wanted};
}

std::pair<std::string, std::string> read_runtime(const XrConnection& xr) {
  XrInstanceProperties found{};
  found.type = XR_TYPE_INSTANCE_PROPERTIES;
  check_xr(xr.function<PFN_xrGetInstanceProperties>("xrGetInstanceProperties")(xr.instance(), &found),
           "xrGetInstanceProperties");
  return {found.runtimeName,
          fmt::format("{}.{}.{}", XR_VERSION_MAJOR(found.runtimeVersion),
                      XR_VERSION_MINOR(found.runtimeVersion), XR_VERSION_PATCH(found.runtimeVersion))};
}

HeadsetSystem read_system(const XrConnection& xr) {
  HeadsetSystem out;
  out.id = find_system(xr);
  read_properties(xr, out);
  read_views(xr, out);
  read_blend_modes(xr, out);
  return out;
}

}  // namespace study
