#pragma once
/// The headset behind a runtime: its name, its views and what it follows.

#include <string>
#include <utility>
#include <vector>

#include "apps/common/headset/loader.hpp"
#include "libsim/render/gl_context.hpp"

namespace apps {

constexpr XrViewConfigurationType stereo_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

struct HeadsetSystem {
  XrSystemId id = XR_NULL_SYSTEM_ID;
  std::string name;
  bool position = false;                       ///< the head's place is followed
  bool eye_gaze = false;                       ///< XR_EXT_eye_gaze_interaction is enabled and served
  bool opaque = false;                         ///< the blend mode that hides the world is offered
  std::vector<XrViewConfigurationView> views;  ///< two
};

/// A context of a kind that the active runtime takes, current on the calling thread: of EGL, or where it
/// takes none of GLX. base::Error when there is no runtime, or no such context.
sim::GlContext make_headset_context();

/// Connects with every extension that the program has a use for; eye tracking only where it is asked for.
XrConnection connect_to_headset(bool eye_gaze = true);

/// The runtime's name, and its version as it counts.
std::pair<std::string, std::string> read_runtime(const XrConnection& xr);

/// base::Error when no headset is connected, or it has no pair of views.
HeadsetSystem read_system(const XrConnection& xr);

}  // namespace apps
