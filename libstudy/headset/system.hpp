#pragma once
/// The headset behind a runtime: its name, views and tracking.

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
  bool opaque = false;                         ///< a blend mode that hides the real world is offered
  std::vector<XrViewConfigurationView> views;  ///< two
};

/// Makes a context that the active runtime takes, current on the calling thread: EGL, or GLX if the runtime
/// takes no EGL. base::Error if there is no runtime, or no such context.
sim::GlContext make_headset_context();

/// Connects with every extension that the program can use; eye tracking only if asked for.
XrConnection connect_to_headset(bool eye_gaze = true);

/// The runtime's name, and its version in its own numbering.
std::pair<std::string, std::string> read_runtime(const XrConnection& xr);

/// base::Error if no headset is connected, or it has no pair of views.
HeadsetSystem read_system(const XrConnection& xr);

}  // namespace study
