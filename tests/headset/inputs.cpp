/// Input of the participant: synchronised, and read by action.

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

const Action& need_action(const Session& session, XrAction handle) {
  const Action& action = find(runtime().actions, handle, "action");
  need(session.attached.contains(action.set), XR_ERROR_ACTIONSET_NOT_ATTACHED,
       "an action whose set is not attached");
  return action;
}

/// Value of a controller's part, found by the end of its path. It comes from the script. Select, trigger and
/// A are also 1 while the hand presses a target on a page.
Input::Value value_of(const std::string& source) {
  const auto knob = [](const char* name) { return runtime().knobs.at(name); };
  const auto ends = [&](const char* part) { return source.ends_with(part); };
  if (ends("/select/click") || ends("/trigger/value") || ends("/trigger") || ends("/a/click") ||
      ends("/pinch_ext/value"))
    return {presses_page() ? 1 : knob("select"), 0};
  if (ends("/menu/click") || ends("/b/click")) return {knob("menu"), 0};
  if (ends("/thumbstick")) return {knob("thumb_x"), knob("thumb_y")};
  if (ends("/thumbstick/x")) return {knob("thumb_x"), 0};
  if (ends("/thumbstick/y")) return {knob("thumb_y"), 0};
  return {0, 0};
}

void read_inputs(Session& session) {
  for (const std::string& profile : {controller_profile(), std::string(gaze_profile)}) {
    for (const Binding& binding : runtime().suggested[profile]) {
      Input& input = session.inputs[binding.source];
      input.before = input.value;
      input.value = value_of(binding.source);
      if (input.value == input.before) continue;
      input.changed = now();
      log_line("input " + binding.source + " " + std::to_string(input.value[0]) + " " +
               std::to_string(input.value[1]));
    }
  }
}

XrResult sync(XrSession session, const XrActionsSyncInfo* info) {
  Session& found = need_session(session);
  need_type(info, XR_TYPE_ACTIONS_SYNC_INFO);
  found.synced.clear();
  for (std::uint32_t i = 0; i < info->countActiveActionSets; ++i) {
    const auto& [set, path] = info->activeActionSets[i];
    find(runtime().action_sets, set, "action set");
    need(found.attached.contains(number_of(set)), XR_ERROR_ACTIONSET_NOT_ATTACHED,
         "an action set that is not attached");
    found.synced.insert(number_of(set));
  }
  if (found.state != XR_SESSION_STATE_FOCUSED) {
    found.synced.clear();
    return XR_SESSION_NOT_FOCUSED;
  }
  read_inputs(found);
  if (!found.told_profiles) {
    XrEventDataInteractionProfileChanged event{};
    event.session = session;
    queue_event(event, XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED);
    found.told_profiles = true;
  }
  return success(found);
}

/// Combined state of an action's sources. `value` is the one of the largest magnitude.
struct Sum {
  bool active = false, changed = false;
  Input::Value value{};
  XrTime time = 0;
};

Sum sum_of(Session& session, const XrActionStateGetInfo* info, XrActionType type) {
  need_type(info, XR_TYPE_ACTION_STATE_GET_INFO);
  const Action& action = need_action(session, info->action);
  need(action.type == type, XR_ERROR_ACTION_TYPE_MISMATCH, "an action of another type");
  Sum out;
  for (const std::string& source :
       sources_of(session, number_of(info->action), subaction_of(action, info->subactionPath))) {
    const Input& input = session.inputs[source];
    const auto size = [](const Input::Value& v) { return v[0] * v[0] + v[1] * v[1]; };
    out.active = true;
    out.changed = out.changed || input.value != input.before;
    out.time = std::max(out.time, input.changed);
    if (size(input.value) > size(out.value)) out.value = input.value;
  }
  return out;
}

template <class State>
void fill(State* state, const Sum& sum) {
  state->changedSinceLastSync = sum.active && sum.changed;
  state->lastChangeTime = sum.active ? sum.time : 0;
  state->isActive = sum.active;
}

XrResult get_boolean(XrSession session, const XrActionStateGetInfo* info, XrActionStateBoolean* state) {
  Session& found = need_session(session);
  need_type(state, XR_TYPE_ACTION_STATE_BOOLEAN);
  const Sum sum = sum_of(found, info, XR_ACTION_TYPE_BOOLEAN_INPUT);
  state->currentState = sum.value[0] > 0.5;
  fill(state, sum);
  return success(found);
}

XrResult get_float(XrSession session, const XrActionStateGetInfo* info, XrActionStateFloat* state) {
  Session& found = need_session(session);
  need_type(state, XR_TYPE_ACTION_STATE_FLOAT);
  const Sum sum = sum_of(found, info, XR_ACTION_TYPE_FLOAT_INPUT);
  state->currentState = static_cast<float>(sum.value[0]);
  fill(state, sum);
  return success(found);
}

XrResult get_vector(XrSession session, const XrActionStateGetInfo* info, XrActionStateVector2f* state) {
  Session& found = need_session(session);
  need_type(state, XR_TYPE_ACTION_STATE_VECTOR2F);
  const Sum sum = sum_of(found, info, XR_ACTION_TYPE_VECTOR2F_INPUT);
  state->currentState = {static_cast<float>(sum.value[0]), static_cast<float>(sum.value[1])};
  fill(state, sum);
  return success(found);
}

XrResult get_pose(XrSession session, const XrActionStateGetInfo* info, XrActionStatePose* state) {
  Session& found = need_session(session);
  need_type(state, XR_TYPE_ACTION_STATE_POSE);
  state->isActive = sum_of(found, info, XR_ACTION_TYPE_POSE_INPUT).active;
  return success(found);
}

XrResult get_profile(XrSession session, XrPath user, XrInteractionProfileState* state) {
  const Session& found = need_session(session);
  need_type(state, XR_TYPE_INTERACTION_PROFILE_STATE);
  need(!found.attached.empty(), XR_ERROR_ACTIONSET_NOT_ATTACHED, "no action set is attached");
  const std::string who = text_of(user);
  need(who == left_hand || who == right_hand || who == "/user/head" || who == "/user/gamepad" || who == eyes,
       XR_ERROR_PATH_UNSUPPORTED, "no user");
  const std::string profile = who == right_hand ? controller_profile() : who == eyes ? gaze_profile : "";
  const auto& paths = runtime().paths;
  const auto path = std::find(paths.begin(), paths.end(), profile);
  const bool current = found.told_profiles && runtime().suggested.contains(profile) && path != paths.end();
  state->interactionProfile = current ? static_cast<XrPath>(path - paths.begin()) + 1 : XR_NULL_PATH;
  return success(found);
}

XrResult get_sources(XrSession session, const XrBoundSourcesForActionEnumerateInfo* info,
                     std::uint32_t capacity, std::uint32_t* count, XrPath* out) {
  Session& found = need_session(session);
  need_type(info, XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO);
  need_action(found, info->action);
  std::vector<XrPath> paths;
  for (const std::string& source : sources_of(found, number_of(info->action), "")) {
    const auto& all = runtime().paths;
    paths.push_back(static_cast<XrPath>(std::find(all.begin(), all.end(), source) - all.begin()) + 1);
  }
  return give_values(paths, capacity, count, out);
}

XrResult haptic(XrSession session, const XrHapticActionInfo* info, const XrHapticBaseHeader*) {
  const Session& found = need_session(session);
  need_type(info, XR_TYPE_HAPTIC_ACTION_INFO);
  need_action(found, info->action);
  return found.state == XR_SESSION_STATE_FOCUSED ? success(found) : XR_SESSION_NOT_FOCUSED;
}
XrResult stop_haptic(XrSession session, const XrHapticActionInfo* info) {
  return haptic(session, info, nullptr);
}

}  // namespace

std::string controller_profile() { return "/interaction_profiles/" + runtime().profile.controller; }

std::vector<std::string> sources_of(const Session& session, std::uint64_t action,
                                    const std::string& subaction) {
  Runtime& all = runtime();
  std::vector<std::string> out;
  const auto found = all.actions.find(action);
  if (found == all.actions.end() || !session.synced.contains(found->second.set)) return out;
  for (const std::string& profile : {controller_profile(), std::string(gaze_profile)}) {
    for (const Binding& binding : all.suggested[profile]) {
      const bool there =
          binding.source.starts_with(right_hand) ||
          (binding.source.starts_with(eyes) && all.profile.gaze && all.knobs.at("gaze_active") != 0);
      if (binding.action == action && there && binding.source.starts_with(subaction))
        out.push_back(binding.source);
    }
  }
  return out;
}

void add_input_functions(Functions& functions) {
  add<"xrSyncActions", sync, Logged::frame_line>(functions);
  add<"xrGetActionStateBoolean", get_boolean, Logged::frame_line>(functions);
  add<"xrGetActionStateFloat", get_float, Logged::frame_line>(functions);
  add<"xrGetActionStateVector2f", get_vector, Logged::frame_line>(functions);
  add<"xrGetActionStatePose", get_pose, Logged::frame_line>(functions);
  add<"xrGetCurrentInteractionProfile", get_profile, Logged::frame_line>(functions);
  add<"xrEnumerateBoundSourcesForAction", get_sources>(functions);
  add<"xrApplyHapticFeedback", haptic>(functions);
  add<"xrStopHapticFeedback", stop_haptic>(functions);
}

}  // namespace simulated
