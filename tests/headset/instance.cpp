/// Instance and system: queries before there is a session.

#include <openxr/openxr_reflection.h>

#include <cstring>

#include "tests/headset/parts.hpp"

namespace simulated {

namespace {

void copy_text(char* to, std::size_t size, const std::string& text) {
  std::strncpy(to, text.c_str(), size - 1);
  to[size - 1] = '\0';
}

XrResult enumerate_extensions(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                              XrExtensionProperties* out) {
  if (layer) return XR_ERROR_API_LAYER_NOT_PRESENT;
  return give_array(runtime().profile.extensions, capacity, count,
                    [&](std::size_t i, const std::string& name) {
                      need_type(&out[i], XR_TYPE_EXTENSION_PROPERTIES);
                      copy_text(out[i].extensionName, sizeof out[i].extensionName, name);
                      out[i].extensionVersion = 1;
                    });
}

XrResult create_instance(const XrInstanceCreateInfo* info, XrInstance* instance) {
  need_type(info, XR_TYPE_INSTANCE_CREATE_INFO);
  need(info->applicationInfo.applicationName[0] != '\0', XR_ERROR_NAME_INVALID, "the program has no name");
  Runtime& all = runtime();
  if (XR_VERSION_MAJOR(info->applicationInfo.apiVersion) != 1) return XR_ERROR_API_VERSION_UNSUPPORTED;
  std::set<std::string> enabled;
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i) {
    const std::string name = info->enabledExtensionNames[i];
    const auto& offered = all.profile.extensions;
    if (std::find(offered.begin(), offered.end(), name) == offered.end())
      return XR_ERROR_EXTENSION_NOT_PRESENT;
    enabled.insert(name);
  }
  all.enabled = enabled;
  all.asked_system = all.asked_graphics = false;
  *instance = new_handle<XrInstance>(all.instances, true);
  return XR_SUCCESS;
}

XrResult destroy_instance(XrInstance instance) {
  Runtime& all = runtime();
  find(all.instances, instance, "instance");
  if (!all.sessions.empty()) note("the instance takes a session with it");
  while (!all.sessions.empty()) end_session_objects(all.sessions.begin()->first);
  all.events.clear();
  all.action_sets.clear();
  all.actions.clear();
  all.suggested.clear();
  all.paths.clear();
  all.instances.erase(number_of(instance));
  all.instance_lost_at = -1;
  return XR_SUCCESS;
}

XrResult get_instance_properties(XrInstance instance, XrInstanceProperties* out) {
  need_instance(instance);
  need_type(out, XR_TYPE_INSTANCE_PROPERTIES);
  out->runtimeVersion = XR_MAKE_VERSION(1, 2, 3);
  copy_text(out->runtimeName, sizeof out->runtimeName, runtime().profile.runtime_name);
  return XR_SUCCESS;
}

/// A name such as "XR_SUCCESS". A value without a name gives `unknown` followed by the number.
std::string name_of(const std::map<int, std::string>& names, int value, const std::string& unknown) {
  const auto found = names.find(value);
  return found == names.end() ? unknown + std::to_string(value) : found->second;
}

#define SIMULATED_NAME(name, value) {value, #name},
XrResult name_result(XrInstance instance, XrResult value, char* out) {
  static const std::map<int, std::string> names{XR_LIST_ENUM_XrResult(SIMULATED_NAME)};
  need_instance(instance);
  copy_text(out, XR_MAX_RESULT_STRING_SIZE,
            name_of(names, value, value < 0 ? "XR_UNKNOWN_FAILURE_" : "XR_UNKNOWN_SUCCESS_"));
  return XR_SUCCESS;
}
XrResult name_type(XrInstance instance, XrStructureType value, char* out) {
  static const std::map<int, std::string> names{XR_LIST_ENUM_XrStructureType(SIMULATED_NAME)};
  need_instance(instance);
  copy_text(out, XR_MAX_STRUCTURE_NAME_SIZE, name_of(names, value, "XR_UNKNOWN_STRUCTURE_TYPE_"));
  return XR_SUCCESS;
}
#undef SIMULATED_NAME

XrResult get_system(XrInstance instance, const XrSystemGetInfo* info, XrSystemId* system) {
  need_instance(instance);
  need_type(info, XR_TYPE_SYSTEM_GET_INFO);
  Runtime& all = runtime();
  if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY || all.profile.headset == "unsupported")
    return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
  if (all.profile.headset == "unavailable") return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  if (double& left = all.knobs.at("unfound"); left > 0) {
    --left;
    return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  }
  all.asked_system = true;
  *system = the_system;
  return XR_SUCCESS;
}

XrResult get_system_properties(XrInstance instance, XrSystemId system, XrSystemProperties* out) {
  need_system(instance, system);
  need_type(out, XR_TYPE_SYSTEM_PROPERTIES);
  need_chain(out->next);
  const Profile& profile = runtime().profile;
  out->systemId = system;
  out->vendorId = 0;
  copy_text(out->systemName, sizeof out->systemName, profile.headset_name);
  out->graphicsProperties = {8192, 8192, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
  out->trackingProperties = {XR_TRUE, profile.knobs.at("position") != 0};
  if (auto* gaze = find_chained<XrSystemEyeGazeInteractionPropertiesEXT>(
          out->next, XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT))
    gaze->supportsEyeGazeInteraction = profile.gaze;
  if (auto* presence = find_chained<XrSystemUserPresencePropertiesEXT>(
          out->next, XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT))
    presence->supportsUserPresence = profile.presence;
  return XR_SUCCESS;
}

XrResult enumerate_view_configurations(XrInstance instance, XrSystemId system, std::uint32_t capacity,
                                       std::uint32_t* count, XrViewConfigurationType* out) {
  need_system(instance, system);
  const std::vector<XrViewConfigurationType> kinds{offered_views()};
  return give_values(kinds, capacity, count, out);
}

XrResult enumerate_views(XrInstance instance, XrSystemId system, XrViewConfigurationType kind,
                         std::uint32_t capacity, std::uint32_t* count, XrViewConfigurationView* out) {
  need_system(instance, system);
  const Profile& profile = runtime().profile;
  need_views(kind);
  const std::vector<int> eyes(profile.stereo ? 2 : 1);
  return give_array(eyes, capacity, count, [&](std::size_t i, int) {
    need_type(&out[i], XR_TYPE_VIEW_CONFIGURATION_VIEW);
    out[i].recommendedImageRectWidth = profile.width;
    out[i].maxImageRectWidth = 2 * profile.width;
    out[i].recommendedImageRectHeight = profile.height;
    out[i].maxImageRectHeight = 2 * profile.height;
    out[i].recommendedSwapchainSampleCount = 1;
    out[i].maxSwapchainSampleCount = 1;
  });
}

XrResult enumerate_blend_modes(XrInstance instance, XrSystemId system, XrViewConfigurationType kind,
                               std::uint32_t capacity, std::uint32_t* count, XrEnvironmentBlendMode* out) {
  need_system(instance, system);
  need_views(kind);
  std::vector<XrEnvironmentBlendMode> modes{XR_ENVIRONMENT_BLEND_MODE_ADDITIVE};
  if (runtime().profile.opaque) modes.insert(modes.begin(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE);
  return give_values(modes, capacity, count, out);
}

XrResult get_view_properties(XrInstance instance, XrSystemId system, XrViewConfigurationType kind,
                             XrViewConfigurationProperties* out) {
  need_system(instance, system);
  need_type(out, XR_TYPE_VIEW_CONFIGURATION_PROPERTIES);
  need_views(kind);
  out->viewConfigurationType = kind;
  out->fovMutable = XR_TRUE;
  return XR_SUCCESS;
}

XrResult get_graphics_requirements(XrInstance instance, XrSystemId system,
                                   XrGraphicsRequirementsOpenGLKHR* out) {
  need_system(instance, system);
  need_type(out, XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  out->minApiVersionSupported = XR_MAKE_VERSION(4, 3, 0);
  out->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  runtime().asked_graphics = true;
  return XR_SUCCESS;
}

}  // namespace

void add_instance_functions(Functions& functions) {
  add<"xrEnumerateInstanceExtensionProperties", enumerate_extensions>(functions);
  add<"xrCreateInstance", create_instance>(functions);
  add<"xrDestroyInstance", destroy_instance>(functions);
  add<"xrGetInstanceProperties", get_instance_properties>(functions);
  add<"xrResultToString", name_result>(functions);
  add<"xrStructureTypeToString", name_type>(functions);
  add<"xrGetSystem", get_system>(functions);
  add<"xrGetSystemProperties", get_system_properties>(functions);
  add<"xrEnumerateViewConfigurations", enumerate_view_configurations>(functions);
  add<"xrEnumerateViewConfigurationViews", enumerate_views>(functions);
  add<"xrGetViewConfigurationProperties", get_view_properties>(functions);
  add<"xrEnumerateEnvironmentBlendModes", enumerate_blend_modes>(functions);
  if (runtime().enabled.contains(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME))
    add<"xrGetOpenGLGraphicsRequirementsKHR", get_graphics_requirements>(functions);
}

}  // namespace simulated
