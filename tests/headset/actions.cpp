/// Actions: creation, bindings, and the one attachment to the session.

#include <cstring>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

void need_name(const char* name, const char* localized) {
  const std::string text = name;
  need(
      !text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_.") == std::string::npos,
      XR_ERROR_NAME_INVALID, "a name that is not well formed");
  need(*localized != '\0', XR_ERROR_LOCALIZED_NAME_INVALID, "no name in the user's language");
}

XrResult create_set(XrInstance instance, const XrActionSetCreateInfo* info, XrActionSet* out) {
  need_instance(instance);
  need_type(info, XR_TYPE_ACTION_SET_CREATE_INFO);
  need_name(info->actionSetName, info->localizedActionSetName);
  auto& sets = runtime().action_sets;
  for (const auto& [number, set] : sets) {
    need(set.name != info->actionSetName, XR_ERROR_NAME_DUPLICATED, "a second set of that name");
    need(set.localized != info->localizedActionSetName, XR_ERROR_LOCALIZED_NAME_DUPLICATED,
         "a second set of that name for the user");
  }
  *out = new_handle<XrActionSet>(sets, ActionSet{info->actionSetName, info->localizedActionSetName, false});
  return XR_SUCCESS;
}

XrResult destroy_set(XrActionSet set) {
  Runtime& all = runtime();
  find(all.action_sets, set, "action set");
  std::erase_if(all.actions, [&](const auto& action) { return action.second.set == number_of(set); });
  all.action_sets.erase(number_of(set));
  return XR_SUCCESS;
}

XrResult create_action(XrActionSet set, const XrActionCreateInfo* info, XrAction* out) {
  const ActionSet& found = find(runtime().action_sets, set, "action set");
  need_type(info, XR_TYPE_ACTION_CREATE_INFO);
  need(!found.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "an action after its set was attached");
  need_name(info->actionName, info->localizedActionName);
  Action fresh{number_of(set), info->actionName, info->actionType, {}};
  for (std::uint32_t i = 0; i < info->countSubactionPaths; ++i)
    fresh.subactions.insert(text_of(info->subactionPaths[i]));
  for (const auto& [number, action] : runtime().actions)
    need(action.set != fresh.set || action.name != fresh.name, XR_ERROR_NAME_DUPLICATED,
         "a second action of that name");
  *out = new_handle<XrAction>(runtime().actions, fresh);
  return XR_SUCCESS;
}

XrResult destroy_action(XrAction action) {
  find(runtime().actions, action, "action");
  runtime().actions.erase(number_of(action));
  return XR_SUCCESS;
}

XrResult suggest(XrInstance instance, const XrInteractionProfileSuggestedBinding* info) {
  need_instance(instance);
  need_type(info, XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
  need_chain(info->next);
  need(info->countSuggestedBindings > 0, XR_ERROR_VALIDATION_FAILURE, "no bindings");
  Runtime& all = runtime();
  const std::string profile = text_of(info->interactionProfile);
  std::vector<Binding> bindings;
  for (std::uint32_t i = 0; i < info->countSuggestedBindings; ++i) {
    const auto& [handle, path] = info->suggestedBindings[i];
    const Action& action = find(all.actions, handle, "action");
    need(!all.action_sets.at(action.set).attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED,
         "a binding after the action's set was attached");
    need_source(profile, text_of(path));
    bindings.push_back({number_of(handle), text_of(path)});
  }
  all.suggested[profile] = bindings;
  return XR_SUCCESS;
}

XrResult attach(XrSession session, const XrSessionActionSetsAttachInfo* info) {
  Session& found = need_session(session);
  need_type(info, XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
  need(info->countActionSets > 0, XR_ERROR_VALIDATION_FAILURE, "no action sets");
  need(found.attached.empty(), XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action sets are attached already");
  for (std::uint32_t i = 0; i < info->countActionSets; ++i) {
    find(runtime().action_sets, info->actionSets[i], "action set").attached = true;
    found.attached.insert(number_of(info->actionSets[i]));
  }
  return success(found);
}

XrResult create_space(XrSession session, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  const Session& found = need_session(session);
  need_type(info, XR_TYPE_ACTION_SPACE_CREATE_INFO);
  const Action& action = find(runtime().actions, info->action, "action");
  need(action.type == XR_ACTION_TYPE_POSE_INPUT, XR_ERROR_ACTION_TYPE_MISMATCH, "an action that is no pose");
  need(is_valid(info->poseInActionSpace), XR_ERROR_POSE_INVALID, "a pose that is none");
  Space fresh;
  fresh.session = number_of(session);
  fresh.offset = from_xr(info->poseInActionSpace);
  fresh.action = number_of(info->action);
  fresh.subaction = subaction_of(action, info->subactionPath);
  *out = new_handle<XrSpace>(runtime().spaces, fresh);
  return success(found);
}

}  // namespace

std::string subaction_of(const Action& action, XrPath path) {
  if (path == XR_NULL_PATH) return "";
  need(action.subactions.contains(text_of(path)), XR_ERROR_PATH_UNSUPPORTED,
       "a path that the action was not made with");
  return text_of(path);
}

void add_action_functions(Functions& functions) {
  add<"xrCreateActionSet", create_set>(functions);
  add<"xrDestroyActionSet", destroy_set>(functions);
  add<"xrCreateAction", create_action>(functions);
  add<"xrDestroyAction", destroy_action>(functions);
  add<"xrSuggestInteractionProfileBindings", suggest>(functions);
  add<"xrAttachSessionActionSets", attach>(functions);
  add<"xrCreateActionSpace", create_space>(functions);
}

}  // namespace simulated
