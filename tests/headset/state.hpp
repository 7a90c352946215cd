#pragma once
/// The state of the simulated runtime.

#include <array>
#include <condition_variable>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "tests/headset/calls.hpp"
#include "tests/headset/pose.hpp"
#include "tests/headset/profile.hpp"

namespace simulated {

/// The OpenGL context that the program gave to the session, by the EGL or the Xlib binding.
struct Graphics {
  EGLDisplay egl_display = EGL_NO_DISPLAY;
  EGLConfig egl_config = nullptr;
  EGLContext egl_context = EGL_NO_CONTEXT, other_context = EGL_NO_CONTEXT;
  Display* x_display = nullptr;
  GLXDrawable drawable = 0;
  GLXContext glx_context = nullptr;
};

/// Both eyes as one call of xrLocateViews returned them.
struct Located {
  XrSpace space = XR_NULL_HANDLE;
  std::array<XrPosef, 2> poses;
  std::array<XrFovf, 2> fovs;
};

struct Frame {
  long index = -1;
  XrTime predicted = 0;
  bool should_render = false;
};

/// State of a controller's part at the last xrSyncActions; `before`: its value at the call before that one.
struct Input {
  using Value = std::array<double, 2>;
  Value value{}, before{};
  XrTime changed = 0;
};

struct Session {
  Graphics graphics;
  XrSessionState state = XR_SESSION_STATE_UNKNOWN;
  bool running = false;
  bool exiting = false;  ///< enters EXITING after the session has ended
  long lost_at = -1;     ///< frame from which every call of the session fails; -1: none
  long frames = 0;       ///< frames ended since xrBeginSession
  bool waited = false;   ///< a frame was waited for and has not begun
  bool begun = false;    ///< a frame has begun and not ended
  Frame waiting, drawing;
  std::set<std::uint64_t> attached, synced;  ///< action sets
  std::map<std::string, Input> inputs;
  bool told_profiles = false;   ///< the event that profiles changed was sent
  std::deque<Located> located;  ///< newest last
};

struct Swapchain {
  std::uint64_t session = 0;
  XrSwapchainCreateInfo info;
  std::vector<GLuint> images;
  std::deque<std::uint32_t> acquired;  ///< oldest first
  bool waited = false;                 ///< the oldest acquired image was waited for
  std::uint32_t next = 0;
  long shown = -1;  ///< index of the image released last
};

struct Space {
  std::uint64_t session = 0;
  XrReferenceSpaceType type = XR_REFERENCE_SPACE_TYPE_LOCAL;
  Pose offset;
  std::uint64_t action = 0;  ///< of an action space, the action's number; else 0
  std::string subaction;
};

struct ActionSet {
  std::string name, localized;
  bool attached = false;
};
struct Action {
  std::uint64_t set;
  std::string name;
  XrActionType type;
  std::set<std::string> subactions;
};
struct Binding {
  std::uint64_t action;
  std::string source;
};

/// The last quad layer of the newest frame.
struct Page {
  Space space;
  Pose pose;
  double width, height;  ///< m
  XrTime since;
};

/// A recentring: from the time `from` on, the reference space LOCAL is turned further to the left by
/// `degrees`.
struct LocalTurn {
  XrTime from;
  double degrees;
};

/// The runtime's time. On the real clock an XrTime is CLOCK_MONOTONIC plus `ahead_of_monotonic`.
struct Clock {
  bool real = false;
  XrTime start = 0;
  XrTime now = 0;             ///< on the virtual clock
  XrTime last_slot = 0;       ///< refresh of the display that the newest frame is meant for
  XrTime last_predicted = 0;  ///< time reported for that refresh: with jitter, or repeated
  XrTime last_end = 0;        ///< when the newest frame of a running session ended
};
constexpr XrTime ahead_of_monotonic = 1'000'000'000'000;

/// All state of one process.
struct Runtime {
  Profile profile;
  std::map<std::string, double> knobs;  ///< as changed by the script
  std::set<std::string> enabled;        ///< extensions of the instance
  std::map<std::uint64_t, bool> instances;
  std::map<std::uint64_t, Session> sessions;
  std::map<std::uint64_t, Swapchain> swapchains;
  std::map<std::uint64_t, Space> spaces;
  std::map<std::uint64_t, ActionSet> action_sets;
  std::map<std::uint64_t, Action> actions;
  std::map<std::string, std::vector<Binding>> suggested;  ///< by interaction profile
  std::vector<std::string> paths;                         ///< an XrPath is an index into it, plus 1
  std::optional<Page> page;
  float wanted_rate = 0;  ///< Hz, requested but not yet in force
  std::deque<XrEventDataBuffer> events;
  Clock clock;
  std::uint64_t next_handle = 1;
  long frames = 0;              ///< frames waited for in this process
  long instance_lost_at = -1;   ///< frame from which every call of the instance fails; -1: none
  bool asked_graphics = false;  ///< xrGetOpenGLGraphicsRequirementsKHR was called
  bool asked_system = false;
  XrSessionState aim = XR_SESSION_STATE_FOCUSED;  ///< state towards which a running session moves
  XrTime worn_from = 0;                           ///< time until which the headset is off
  int dropped = 0;                                ///< number of slots that the next wait skips
  bool repeats = false;                           ///< the next wait predicts the last time again
  int untimed = 0;                                ///< next frames whose predicted time is negative
  double hang_seconds = 0;                        ///< duration for which the next wait hangs
  std::vector<LocalTurn> local_turns;             ///< turns of the space LOCAL by recentring
};
Runtime& runtime();
/// Resets all state and reads the profile again if VIP_XR_PROFILE or VIP_XR_LOG has changed since the last
/// call.
void restart();
/// Notified when a frame begins or a session ends.
std::condition_variable_any& frame_begun();

constexpr XrSystemId the_system = 7;
constexpr XrViewConfigurationType stereo_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
constexpr XrViewConfigurationType mono_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;
inline XrViewConfigurationType offered_views() {
  return runtime().profile.stereo ? stereo_views : mono_views;
}

template <class Handle>
std::uint64_t number_of(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}
template <class Handle>
Handle as_handle(std::uint64_t number) {
  return reinterpret_cast<Handle>(number);
}
/// Adds an object to `living` under a handle that was never used before.
template <class Handle, class T>
Handle new_handle(std::map<std::uint64_t, T>& living, T object) {
  const std::uint64_t number = runtime().next_handle++ << 4;
  living.emplace(number, std::move(object));
  return as_handle<Handle>(number);
}
template <class Handle, class T>
T& find(std::map<std::uint64_t, T>& living, Handle handle, const char* what) {
  const auto found = living.find(number_of(handle));
  need(found != living.end(), XR_ERROR_HANDLE_INVALID, std::string("the ") + what + " is not alive");
  return found->second;
}

/// Each refuses a handle that does not exist, and fails if the instance or the session is lost.
void need_instance(XrInstance instance);
void need_system(XrInstance instance, XrSystemId system);
Session& need_session(XrSession session);
void need_session_number(std::uint64_t session);
/// Refuses a view configuration that is not offered.
void need_views(XrViewConfigurationType kind);
/// Refuses if the extension is not enabled.
void need_enabled(const char* extension);
/// XR_SESSION_LOSS_PENDING if the session is in the state LOSS_PENDING or the profile sets `positive`;
/// otherwise XR_SUCCESS.
XrResult success(const Session& session);

/// Deletes a session, its swapchains and its spaces, and detaches all action sets.
void end_session_objects(std::uint64_t session);

}  // namespace simulated
