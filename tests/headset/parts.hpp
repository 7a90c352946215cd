#pragma once
/// Functions that the runtime's source files share, by file.

#include "tests/headset/state.hpp"

namespace simulated {

// events.cpp
template <class T>
void queue_event(T event, XrStructureType type) {
  static_assert(sizeof(T) <= sizeof(XrEventDataBuffer));
  XrEventDataBuffer buffer{};
  event.type = type;
  std::copy_n(reinterpret_cast<const char*>(&event), sizeof event, reinterpret_cast<char*>(&buffer));
  runtime().events.push_back(buffer);
}
const char* name_of(XrSessionState state);
void enter(XrSession session, XrSessionState state);
/// Moves a running session's state one step up towards Runtime::aim, or down to it through all states
/// between. The first step up comes after a frame has ended.
void step_state(XrSession session);
/// Moves an idle session to READY if the headset is worn and the session is not exiting.
void offer_ready();

// script.cpp
/// Runs the profile's events for this frame.
void play_script(XrSession session, long frame);

// rates.cpp
void change_rate(float hertz);
/// Changes to the rate that the program requested last, if there is such a request.
void take_wanted_rate();

// time.cpp
XrTime now();
XrDuration period();
/// On the real clock sleeps until `time` with lock() released. On the virtual clock advances the time to
/// `time`.
void wait_until(XrTime time);

// layers.cpp
/// An image that a frame shows.
struct Shown {
  const XrSwapchainSubImage* part;
  std::string name;  ///< "left", "right" or "quad", with the layer's number unless that is 0
};
/// Refuses a frame that breaks the specification. Returns its images, and in `text` their description for the
/// log.
std::vector<Shown> check_layers(const Session& session, const XrFrameEndInfo& info, std::string& text);

// images.cpp
/// Writes the images as files if the profile lists the frame in `dump`. Returns their hashes for the log if
/// files are written or `hash` is set. The session's context must be current.
std::string look_at(const std::vector<Shown>& images, long frame);

// motion.cpp
Pose head_at(XrTime time);
Pose eye_at(XrTime time, int eye);
XrFovf fov_of(int eye);

// spaces.cpp
struct Placed {
  XrSpaceLocationFlags flags;
  XrPosef pose;
};
Placed locate(const Space& what, const Space& from, XrTime time);
Placed locate_eye(int eye, const Space& from, XrTime time);

Pose place_of(const Space& space, XrTime time);

// paths.cpp
constexpr const char* left_hand = "/user/hand/left";
constexpr const char* right_hand = "/user/hand/right";
constexpr const char* eyes = "/user/eyes_ext";
constexpr const char* gaze_profile = "/interaction_profiles/ext/eye_gaze_interaction";
constexpr const char* gaze_source = "/user/eyes_ext/input/gaze_ext/pose";
const std::string& text_of(XrPath path);
/// Refuses a source that is not part of the interaction profile.
void need_source(const std::string& profile, const std::string& source);

// actions.cpp
/// The path's text, "" for none; refuses paths that the action was not made with.
std::string subaction_of(const Action& action, XrPath path);

// inputs.cpp
std::string controller_profile();
/// Sources, beginning with `subaction`, that are bound to an action and present: those of the right hand, and
/// those of the eyes if the profile sets `gaze`. Empty if the session had no focus at the last xrSyncActions,
/// or that call did not name the action's set.
std::vector<std::string> sources_of(const Session& session, std::uint64_t action,
                                    const std::string& subaction);

// pointing.cpp
struct Gaze {
  Pose pose;
  XrTime time = 0;  ///< when the eye tracker took the sample
  bool valid = false, tracked = false;
};
Gaze gaze_at(XrTime time);
Pose hand_at(XrTime time);
/// True if the hand presses the target that it points at on the page.
bool presses_page();
void see_page(const std::vector<const XrCompositionLayerQuad*>& quads);

// The functions of each file.
void add_instance_functions(Functions& functions);
void add_session_functions(Functions& functions);
void add_event_functions(Functions& functions);
void add_frame_functions(Functions& functions);
void add_swapchain_functions(Functions& functions);
void add_space_functions(Functions& functions);
void add_view_functions(Functions& functions);
void add_time_functions(Functions& functions);
void add_rate_functions(Functions& functions);
void add_path_functions(Functions& functions);
void add_action_functions(Functions& functions);
void add_input_functions(Functions& functions);

}  // namespace simulated
