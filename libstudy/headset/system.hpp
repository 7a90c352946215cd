#pragma once
/// The headset of an OpenXR runtime (its "system"): name, views and tracking.

#include <string>
#include <utility>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libstudy/headset/loader.hpp"

namespace study {

constexpr XrViewConfigurationType stereo_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

struct HeadsetSystem {
  XrSystemId id = XR_NULL_SYSTEM_ID;
  std::string name;
  bool position = false;                       ///< the head's position is tracked
  bool eye_gaze = false;                       ///< XR_EXT_eye_gaze_interaction is enabled and supported
  bool user_presence = false;                  ///< XR_EXT_user_presence is enabled and supported
  bool opaque = false;                         ///< a blend mode that hides the real world is offered
  std::vector<XrViewConfigurationView> views;  ///< left and right
};

/// Makes an OpenGL context that the active runtime accepts, current on the calling thread: an EGL context, or
/// GLX if the runtime does not accept EGL. The environment variable VIP_OPENXR_GRAPHICS (egl or xlib) chooses
/// one of them. base::Error if there is no runtime, or no such context.
sim::GlContext make_headset_context();

/// Connects to the runtime and enables every offered extension that the program can use; eye tracking only if
/// eye_gaze is true, and the report of who wears the headset only if user_presence is true.
XrConnection connect_to_headset(bool eye_gaze = true, bool user_presence = true);

/// The runtime's name and version.
std::pair<std::string, std::string> read_runtime(const XrConnection& xr);

/// Reads the properties of the headset. base::Error if no headset is connected, or it has no pair of views.
HeadsetSystem read_system(const XrConnection& xr);

}  // namespace study
