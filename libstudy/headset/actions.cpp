#include "libstudy/headset/actions.hpp"

#include <cstring>

#include "stats/base/error.hpp"

namespace study {

namespace {

struct Binding {
  XrAction action;
  std::string path;
};

void name(char* to, std::size_t size, const char* text) { std::strncpy(to, text, size - 1); }

XrPath path_of(const SessionHandle& session, const std::string& text) {
  XrPath path = XR_NULL_PATH;
  session.call<PFN_xrStringToPath>("xrStringToPath", session.xr().instance(), text.c_str(), &path);
  return path;
}

XrActionSet make_set(const SessionHandle& session) {
  XrActionSetCreateInfo info{};
  info.type = XR_TYPE_ACTION_SET_CREATE_INFO;
  name(info.actionSetName, sizeof info.actionSetName, "study");
  name(info.localizedActionSetName, sizeof info.localizedActionSetName, "Study");
  XrActionSet set = XR_NULL_HANDLE;
  session.call<PFN_xrCreateActionSet>("xrCreateActionSet", session.xr().instance(), &info, &set);
  return set;
}

XrAction make_action(const SessionHandle& session, XrActionSet set, XrActionType type, const char* id,
                     const char* title, const std::vector<XrPath>& hands = {}) {
  XrActionCreateInfo info{};
  info.type = XR_TYPE_ACTION_CREATE_INFO;
  info.actionType = type;
  name(info.actionName, sizeof info.actionName, id);
  name(info.localizedActionName, sizeof info.localizedActionName, title);
  info.countSubactionPaths = static_cast<std::uint32_t>(hands.size());
  info.subactionPaths = hands.empty() ? nullptr : hands.data();
  XrAction action = XR_NULL_HANDLE;
  session.call<PFN_xrCreateAction>("xrCreateAction", set, &info, &action);
  return action;
}

/// Suggests the bindings of one kind of controller to the runtime. Returns false if the runtime does not
/// support this kind.
bool suggest_profile(const SessionHandle& session, const std::string& profile,
                     const std::vector<Binding>& bindings) {
  std::vector<XrActionSuggestedBinding> suggested;
  for (const Binding& one : bindings) suggested.push_back({one.action, path_of(session, one.path)});
  XrInteractionProfileSuggestedBinding info{};
  info.type = XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING;
  info.interactionProfile = path_of(session, profile);
  info.countSuggestedBindings = static_cast<std::uint32_t>(suggested.size());
  info.suggestedBindings = suggested.data();
  const XrResult result = session.attempt<PFN_xrSuggestInteractionProfileBindings>(
      "xrSuggestInteractionProfileBindings", session.xr().instance(), &info);
  if (result == XR_ERROR_PATH_UNSUPPORTED) return false;
  check_xr(result, "xrSuggestInteractionProfileBindings");
  return true;
}

/// A kind of controller. Parts are paths below a hand; null: it has no such part. menu: `y_and_b`: the button
/// is Y of the left hand and B of the right one.
struct Controller {
  const char *profile, *select, *menu, *stick;
  const char* extension = nullptr;  ///< that adds the profile; null: every runtime knows the profile
};

constexpr const char *trigger = "/input/trigger/value", *thumbstick = "/input/thumbstick",
                     *menu_button = "/input/menu/click";
// These controllers have no menu button with one name on both hands. The runtime may reserve the menu button
// of the left one.
constexpr const char* y_and_b = "";
// Every runtime supports the simple controller, which has no stick. A pinch of thumb and finger is the select
// button of a tracked hand, which has no menu button: each page has a button to stop.
constexpr Controller controllers[] = {
    {"khr/simple_controller", "/input/select/click", menu_button, nullptr},
    {"oculus/touch_controller", trigger, y_and_b, thumbstick},
    {"valve/index_controller", trigger, "/input/b/click", thumbstick},
    {"microsoft/motion_controller", trigger, menu_button, thumbstick},
    {"htc/vive_controller", "/input/trigger/click", menu_button, "/input/trackpad"},
    {"htc/vive_focus3_controller", trigger, y_and_b, thumbstick, "XR_HTC_vive_focus3_controller_interaction"},
    {"bytedance/pico_neo3_controller", trigger, y_and_b, thumbstick, "XR_BD_controller_interaction"},
    {"bytedance/pico4_controller", trigger, y_and_b, thumbstick, "XR_BD_controller_interaction"},
    {"ext/hand_interaction_ext", "/input/pinch_ext/value", nullptr, nullptr, "XR_EXT_hand_interaction"},
};

}  // namespace

std::vector<std::string> controller_extensions() {
  std::vector<std::string> out;
  for (const Controller& one : controllers)
    if (one.extension && (out.empty() || out.back() != one.extension)) out.emplace_back(one.extension);
  return out;
}

Actions::Actions(const SessionHandle& session, RuntimeClock& clock, bool eye_gaze)
    : session_(session), clock_(clock) {
  hands_ = {path_of(session, "/user/hand/left"), path_of(session, "/user/hand/right")};
  set_ = make_set(session);
  try {
    make_actions(eye_gaze);
    suggest(eye_gaze);
    attach();
    for (const XrPath hand : hands_) aims_.emplace_back(session, aim_, hand);
    if (eye_gaze) gaze_space_ = std::make_unique<Space>(session, gaze_);
  } catch (...) {
    session_.destroy<PFN_xrDestroyActionSet>("xrDestroyActionSet", set_);
    throw;
  }
}

Actions::~Actions() {
  gaze_space_.reset();
  aims_.clear();
  session_.destroy<PFN_xrDestroyActionSet>("xrDestroyActionSet", set_);  // also destroys its actions
}

void Actions::make_actions(bool eye_gaze) {
  const std::vector<XrPath> hands(hands_.begin(), hands_.end());
  select_ = make_action(session_, set_, XR_ACTION_TYPE_BOOLEAN_INPUT, "select", "Select");
  menu_ = make_action(session_, set_, XR_ACTION_TYPE_BOOLEAN_INPUT, "menu", "Ask to stop");
  stick_ = make_action(session_, set_, XR_ACTION_TYPE_VECTOR2F_INPUT, "choose", "Choose");
  aim_ = make_action(session_, set_, XR_ACTION_TYPE_POSE_INPUT, "aim", "Point", hands);
  if (eye_gaze) gaze_ = make_action(session_, set_, XR_ACTION_TYPE_POSE_INPUT, "gaze", "Gaze");
}

void Actions::suggest(bool eye_gaze) const {
  for (const Controller& one : controllers) {
    if (one.extension && !session_.xr().has(one.extension)) continue;
    std::vector<Binding> bindings;
    for (const std::string hand : {"/user/hand/left", "/user/hand/right"}) {
      bindings.push_back({select_, hand + one.select});
      bindings.push_back({aim_, hand + "/input/aim/pose"});
      if (one.stick) bindings.push_back({stick_, hand + one.stick});
      if (one.menu && *one.menu) bindings.push_back({menu_, hand + one.menu});
    }
    if (one.menu && !*one.menu) {  // y_and_b
      bindings.push_back({menu_, "/user/hand/left/input/y/click"});
      bindings.push_back({menu_, "/user/hand/right/input/b/click"});
    }
    suggest_profile(session_, std::string("/interaction_profiles/") + one.profile, bindings);
  }
  if (eye_gaze && !suggest_profile(session_, "/interaction_profiles/ext/eye_gaze_interaction",
                                   {{gaze_, "/user/eyes_ext/input/gaze_ext/pose"}})) {
    throw base::Error("headset", "the runtime offers eye tracking but rejects its input profile",
                      "update the headset's software, or choose another --gaze than tracked");
  }
}

void Actions::attach() const {
  XrSessionActionSetsAttachInfo info{};
  info.type = XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO;
  info.countActionSets = 1;
  info.actionSets = &set_;
  session_.call<PFN_xrAttachSessionActionSets>("xrAttachSessionActionSets", session_.get(), &info);
}

bool Actions::sync() const {
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  XrActionsSyncInfo info{};
  info.type = XR_TYPE_ACTIONS_SYNC_INFO;
  info.countActiveActionSets = 1;
  info.activeActionSets = &active;
  return session_.call<PFN_xrSyncActions>("xrSyncActions", session_.get(), &info) != XR_SESSION_NOT_FOCUSED;
}

XrActionStateGetInfo Actions::ask(XrAction action, XrPath hand) const {
  XrActionStateGetInfo info{};
  info.type = XR_TYPE_ACTION_STATE_GET_INFO;
  info.action = action;
  info.subactionPath = hand;
  return info;
}

bool Actions::is_active(XrAction pose, XrPath hand) const {
  const XrActionStateGetInfo info = ask(pose, hand);
  XrActionStatePose state{};
  state.type = XR_TYPE_ACTION_STATE_POSE;
  session_.call<PFN_xrGetActionStatePose>("xrGetActionStatePose", session_.get(), &info, &state);
  return state.isActive;
}

std::optional<HeadsetGaze> Actions::read_gaze(const Space& world, XrTime time) {
  if (!gaze_space_ || !is_active(gaze_)) return {};
  XrEyeGazeSampleTimeEXT sampled{};
  sampled.type = XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT;
  HeadsetGaze out;
  out.ray = gaze_space_->locate(world, time, &sampled);
  if (sampled.time > 0) out.sampled_ns = clock_.to_ns(sampled.time);
  return out;
}

XrActionStateBoolean Actions::read_button(XrAction action) const {
  const XrActionStateGetInfo info = ask(action);
  XrActionStateBoolean state{};
  state.type = XR_TYPE_ACTION_STATE_BOOLEAN;
  session_.call<PFN_xrGetActionStateBoolean>("xrGetActionStateBoolean", session_.get(), &info, &state);
  return state;
}

HeadsetHands Actions::read_hands(const Space& world, XrTime time) const {
  HeadsetHands out;
  const XrActionStateBoolean select = read_button(select_), menu = read_button(menu_);
  out.select = select.isActive && select.currentState;
  out.menu = menu.isActive && menu.currentState;
  out.select_began = out.select && select.changedSinceLastSync;
  const XrActionStateGetInfo ask_stick = ask(stick_);
  XrActionStateVector2f stick{};
  stick.type = XR_TYPE_ACTION_STATE_VECTOR2F;
  session_.call<PFN_xrGetActionStateVector2f>("xrGetActionStateVector2f", session_.get(), &ask_stick, &stick);
  if (stick.isActive) out.stick = {stick.currentState.x, stick.currentState.y};
  for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
    if (is_active(aim_, hands_[hand])) out.aim[hand] = aims_[hand].locate(world, time);
  }
  return out;
}

void Actions::read(const Space& world, XrTime time, HeadsetInput& out) {
  out.focused = sync();
  if (!out.focused) return;
  out.gaze = read_gaze(world, time);
  out.hands = read_hands(world, time);
}

}  // namespace study
