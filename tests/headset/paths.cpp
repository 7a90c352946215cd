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
  need(found != controllers.end(), unsupported, profile + " is no interaction profile");
  const auto& parts = found->second;
  need(std::find(parts.begin(), parts.end(), part) != parts.end(), unsupported,
       source + " is no part of " + profile);
}

void add_path_functions(Functions& functions) {
  add<"xrStringToPath", string_to_path>(functions);
  add<"xrPathToString", path_to_string>(functions);
}

}  // namespace simulated
