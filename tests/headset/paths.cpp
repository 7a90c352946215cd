/// Paths, and the parts of controllers for which a program may suggest bindings.

#include <cstring>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

bool is_well_formed(const std::string& text) {
  constexpr const char* letters = "abcdefghijklmnopqrstuvwxyz0123456789-_./";
  return text.size() > 1 && text.size() < XR_MAX_PATH_LENGTH && text.front() == '/' && text.back() != '/' &&
         text.find_first_not_of(letters) == std::string::npos && text.find("//") == std::string::npos;
}

XrResult string_to_path(XrInstance instance, const char* text, XrPath* path) {
  need_instance(instance);
  need(text && is_well_formed(text), XR_ERROR_PATH_FORMAT_INVALID, "a path that is not well formed");
  auto& paths = runtime().paths;
  const auto found = std::find(paths.begin(), paths.end(), text);
  *path = static_cast<XrPath>(found - paths.begin()) + 1;
  if (found == paths.end()) paths.emplace_back(text);
  return XR_SUCCESS;
}

XrResult path_to_string(XrInstance instance, XrPath path, std::uint32_t capacity, std::uint32_t* count,
                        char* out) {
  need_instance(instance);
  const std::string& text = text_of(path);
  return give_values(std::vector<char>(text.c_str(), text.c_str() + text.size() + 1), capacity, count, out);
}

/// Parts of each controller, below "/user/hand/left/" or "/user/hand/right/".
const std::map<std::string, std::vector<std::string>> controllers{
    {"/interaction_profiles/khr/simple_controller",
     {"input/select/click", "input/menu/click", "input/grip/pose", "input/aim/pose", "output/haptic"}},
    {"/interaction_profiles/oculus/touch_controller",
     {"input/a/click", "input/b/click", "input/x/click", "input/y/click", "input/menu/click",
      "input/squeeze/value", "input/trigger/value", "input/trigger", "input/thumbstick", "input/thumbstick/x",
      "input/thumbstick/y", "input/thumbstick/click", "input/grip/pose", "input/aim/pose", "output/haptic"}},
};
/// Parts of a controller with a trigger, a thumbstick, and other buttons on each hand.
const std::vector<std::string> two_handed{"input/x/click",       "input/y/click",    "input/a/click",
                                          "input/b/click",       "input/menu/click", "input/trigger/value",
                                          "input/squeeze/value", "input/thumbstick", "input/grip/pose",
                                          "input/aim/pose",      "output/haptic"};
/// Profiles that an extension adds: the extension, and the parts.
const std::map<std::string, std::pair<std::string, std::vector<std::string>>> extension_controllers{
    {"/interaction_profiles/htc/vive_focus3_controller",
     {"XR_HTC_vive_focus3_controller_interaction", two_handed}},
    {"/interaction_profiles/bytedance/pico_neo3_controller", {"XR_BD_controller_interaction", two_handed}},
    {"/interaction_profiles/bytedance/pico4_controller", {"XR_BD_controller_interaction", two_handed}},
    {"/interaction_profiles/ext/hand_interaction_ext",
     {"XR_EXT_hand_interaction",
      {"input/pinch_ext/value", "input/pinch_ext/pose", "input/aim_activate_ext/value",
       "input/grasp_ext/value", "input/aim/pose", "input/grip/pose"}}},
};
/// Profiles of the specification whose parts are not checked.
const std::set<std::string> other_controllers{
    "/interaction_profiles/google/daydream_controller",  "/interaction_profiles/htc/vive_controller",
    "/interaction_profiles/microsoft/motion_controller", "/interaction_profiles/oculus/go_controller",
    "/interaction_profiles/valve/index_controller",
};

}  // namespace

const std::string& text_of(XrPath path) {
  const auto& paths = runtime().paths;
  need(path != XR_NULL_PATH && path <= paths.size(), XR_ERROR_PATH_INVALID, "a path that was not given");
  return paths[path - 1];
}

void need_source(const std::string& profile, const std::string& source) {
  constexpr XrResult unsupported = XR_ERROR_PATH_UNSUPPORTED;
  if (profile == gaze_profile) {
    need(runtime().enabled.contains(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME), unsupported,
         "the eyes' profile, whose extension is not enabled");
    need(source == gaze_source, unsupported, source + " is no part of " + profile);
    return;
  }
  std::string part;
  for (const std::string hand : {left_hand, right_hand}) {
    if (source.starts_with(hand + "/")) part = source.substr(hand.size() + 1);
  }
  need(!part.empty(), unsupported, source + " is no part of " + profile);
  if (other_controllers.contains(profile)) return;
  const auto found = controllers.find(profile);
  const auto added = extension_controllers.find(profile);
  if (added != extension_controllers.end())
    need(runtime().enabled.contains(added->second.first), unsupported,
         profile + ", whose extension is not enabled");
  need(found != controllers.end() || added != extension_controllers.end(), unsupported,
       profile + " is no interaction profile");
  const auto& parts = found != controllers.end() ? found->second : added->second.second;
  need(std::find(parts.begin(), parts.end(), part) != parts.end(), unsupported,
       source + " is no part of " + profile);
}

void add_path_functions(Functions& functions) {
  add<"xrStringToPath", string_to_path>(functions);
  add<"xrPathToString", path_to_string>(functions);
}

}  // namespace simulated
