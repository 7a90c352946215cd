#pragma once
/// What the parts of the runtime do for each other, by file.

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
/// One step towards the state that the script wants; down all at once.
void step_state(XrSession session);
/// READY, when the headset is on the head and the session waits for it.
void offer_ready();

// script.cpp
/// What the profile says happens at this frame.
void play_script(XrSession session, long frame);

// rates.cpp
void change_rate(float hertz);
/// Changes to the rate that was asked for.
void take_wanted_rate();

// time.cpp
XrTime now();
XrDuration period();
/// Waits until then: at once on the virtual clock. Gives up the lock meanwhile.
void wait_until(XrTime time);

// layers.cpp
/// An image that a frame shows.
struct Shown {
  const XrSwapchainSubImage* part;
  std::string name;  ///< "left", "right" or "quad", with the layer's number unless that is 0
};
/// Refuses a frame that breaks the specification; gives the images it shows, and `text` for the log.
std::vector<Shown> check_layers(const Session& session, const XrFrameEndInfo& info, std::string& text);

// images.cpp
/// Writes the frame's images where the profile asks for it, and gives what they hold for the log.
/// The session's context is current.
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
/// Refuses what is no part of the interaction profile.
void need_source(const std::string& profile, const std::string& source);

// actions.cpp
/// The path's text, "" for none; refuses those that the action was not made with.
std::string subaction_of(const Action& action, XrPath path);

// inputs.cpp
std::string controller_profile();
/// What moves an action now; empty while it is not active.
std::vector<std::string> sources_of(const Session& session, std::uint64_t action,
                                    const std::string& subaction);

// pointing.cpp
struct Gaze {
  Pose pose;
  XrTime time = 0;  ///< of the sample
  bool valid = false, tracked = false;
};
Gaze gaze_at(XrTime time);
Pose hand_at(XrTime time);
/// Whether the hand presses what it points at on the page.
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
