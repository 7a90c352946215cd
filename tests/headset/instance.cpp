/// Instance and system: what can be asked before there is a picture.

#include <algorithm>
#include <cstring>
#include <fstream>

#include "tests/headset/state.hpp"

namespace simulated {

Runtime& runtime() {
  static Runtime one{read_profile(), {}, {}, {}, 1, false, false};
  return one;
}

void log_line(const std::string& text) {
  if (const char* path = std::getenv("VIP_XR_LOG")) std::ofstream(path, std::ios::app) << text << "\n";
}
void breach(const std::string& text) { log_line("BREACH " + text); }

XrResult check_instance(XrInstance instance, const char* call) {
  log_line(call);
  if (runtime().instances.contains(number_of(instance))) return XR_SUCCESS;
  breach(std::string(call) + ": the instance is not alive");
  return XR_ERROR_HANDLE_INVALID;
}

XrResult check_system(XrInstance instance, XrSystemId system, const char* call) {
  if (const XrResult result = check_instance(instance, call); result != XR_SUCCESS) return result;
  if (system == the_system && runtime().asked_system) return XR_SUCCESS;
  breach(std::string(call) + ": a system that xrGetSystem did not give");
  return XR_ERROR_SYSTEM_INVALID;
}

XrResult check_enabled(const char* extension, const char* call) {
  if (runtime().enabled.contains(extension)) return XR_SUCCESS;
  breach(std::string(call) + ": " + extension + " is not enabled");
  return XR_ERROR_FUNCTION_UNSUPPORTED;
}

namespace {

constexpr XrViewConfigurationType stereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
constexpr XrViewConfigurationType mono = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;

void copy_text(char* to, std::size_t size, const std::string& text) {
  std::strncpy(to, text.c_str(), size - 1);
  to[size - 1] = '\0';
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_extensions(const char* layer, std::uint32_t capacity,
                                                    std::uint32_t* count, XrExtensionProperties* out) {
  constexpr const char* call = "xrEnumerateInstanceExtensionProperties";
  log_line(call);
  if (layer) return XR_ERROR_API_LAYER_NOT_PRESENT;
  return give_array(
      runtime().profile.extensions, capacity, count,
      [&](std::size_t i, const std::string& name) {
        if (const XrResult result = check_type(&out[i], XR_TYPE_EXTENSION_PROPERTIES, call);
            result != XR_SUCCESS)
          return result;
        copy_text(out[i].extensionName, sizeof out[i].extensionName, name);
        out[i].extensionVersion = 1;
        return XR_SUCCESS;
      },
      call);
}

XRAPI_ATTR XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, XrInstance* instance) {
  constexpr const char* call = "xrCreateInstance";
  log_line(call);
  if (const XrResult result = check_type(info, XR_TYPE_INSTANCE_CREATE_INFO, call); result != XR_SUCCESS)
    return result;
  if (info->applicationInfo.applicationName[0] == '\0') {
    breach("xrCreateInstance: the program has no name");
    return XR_ERROR_NAME_INVALID;
  }
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
  *instance = new_handle<XrInstance>(all.instances);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroy_instance(XrInstance instance) {
  if (const XrResult result = check_instance(instance, "xrDestroyInstance"); result != XR_SUCCESS)
    return result;
  Runtime& all = runtime();
  if (!all.sessions.empty()) log_line("note: the instance takes a session with it");
  all.sessions.clear();
  all.instances.erase(number_of(instance));
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL get_instance_properties(XrInstance instance, XrInstanceProperties* out) {
  constexpr const char* call = "xrGetInstanceProperties";
  if (const XrResult result = check_instance(instance, call); result != XR_SUCCESS) return result;
  if (const XrResult result = check_type(out, XR_TYPE_INSTANCE_PROPERTIES, call); result != XR_SUCCESS)
    return result;
  out->runtimeVersion = XR_MAKE_VERSION(1, 2, 3);
  copy_text(out->runtimeName, sizeof out->runtimeName, runtime().profile.runtime_name);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL get_system(XrInstance instance, const XrSystemGetInfo* info,
                                          XrSystemId* system) {
  constexpr const char* call = "xrGetSystem";
  if (const XrResult result = check_instance(instance, call); result != XR_SUCCESS) return result;
  if (const XrResult result = check_type(info, XR_TYPE_SYSTEM_GET_INFO, call); result != XR_SUCCESS)
    return result;
  Runtime& all = runtime();
  if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY || all.profile.headset == "unsupported")
    return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
  if (all.profile.headset == "unavailable") return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  all.asked_system = true;
  *system = the_system;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL get_system_properties(XrInstance instance, XrSystemId system,
                                                     XrSystemProperties* out) {
  constexpr const char* call = "xrGetSystemProperties";
  if (const XrResult result = check_system(instance, system, call); result != XR_SUCCESS) return result;
  if (const XrResult result = check_type(out, XR_TYPE_SYSTEM_PROPERTIES, call); result != XR_SUCCESS)
    return result;
  const Profile& profile = runtime().profile;
  out->systemId = system;
  out->vendorId = 0;
  copy_text(out->systemName, sizeof out->systemName, profile.headset_name);
  out->graphicsProperties = {8192, 8192, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
  out->trackingProperties = {XR_TRUE, profile.position};
  for (auto* next = static_cast<XrBaseOutStructure*>(out->next); next; next = next->next) {
    if (next->type != XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT) continue;
    if (const XrResult result = check_enabled(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, call);
        result != XR_SUCCESS)
      return XR_ERROR_VALIDATION_FAILURE;
    reinterpret_cast<XrSystemEyeGazeInteractionPropertiesEXT*>(next)->supportsEyeGazeInteraction =
        profile.gaze;
  }
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_view_configurations(XrInstance instance, XrSystemId system,
                                                             std::uint32_t capacity, std::uint32_t* count,
                                                             XrViewConfigurationType* out) {
  constexpr const char* call = "xrEnumerateViewConfigurations";
  if (const XrResult result = check_system(instance, system, call); result != XR_SUCCESS) return result;
  const std::vector<XrViewConfigurationType> kinds{runtime().profile.stereo ? stereo : mono};
  return give_values(kinds, capacity, count, out, call);
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_views(XrInstance instance, XrSystemId system,
                                               XrViewConfigurationType kind, std::uint32_t capacity,
                                               std::uint32_t* count, XrViewConfigurationView* out) {
  constexpr const char* call = "xrEnumerateViewConfigurationViews";
  if (const XrResult result = check_system(instance, system, call); result != XR_SUCCESS) return result;
  const Profile& profile = runtime().profile;
  if (kind != (profile.stereo ? stereo : mono)) {
    breach(std::string(call) + ": a kind of views that is not listed");
    return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  }
  const std::vector<int> eyes(profile.stereo ? 2 : 1);
  return give_array(
      eyes, capacity, count,
      [&](std::size_t i, int) {
        if (const XrResult result = check_type(&out[i], XR_TYPE_VIEW_CONFIGURATION_VIEW, call);
            result != XR_SUCCESS)
          return result;
        out[i].recommendedImageRectWidth = profile.width;
        out[i].maxImageRectWidth = 2 * profile.width;
        out[i].recommendedImageRectHeight = profile.height;
        out[i].maxImageRectHeight = 2 * profile.height;
        out[i].recommendedSwapchainSampleCount = 1;
        out[i].maxSwapchainSampleCount = 4;
        return XR_SUCCESS;
      },
      call);
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_blend_modes(XrInstance instance, XrSystemId system,
                                                     XrViewConfigurationType kind, std::uint32_t capacity,
                                                     std::uint32_t* count, XrEnvironmentBlendMode* out) {
  constexpr const char* call = "xrEnumerateEnvironmentBlendModes";
  if (const XrResult result = check_system(instance, system, call); result != XR_SUCCESS) return result;
  const Profile& profile = runtime().profile;
  if (kind != (profile.stereo ? stereo : mono)) return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  std::vector<XrEnvironmentBlendMode> modes{XR_ENVIRONMENT_BLEND_MODE_ADDITIVE};
  if (profile.opaque) modes.insert(modes.begin(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE);
  return give_values(modes, capacity, count, out, call);
}

XRAPI_ATTR XrResult XRAPI_CALL get_graphics_requirements(XrInstance instance, XrSystemId system,
                                                         XrGraphicsRequirementsOpenGLKHR* out) {
  constexpr const char* call = "xrGetOpenGLGraphicsRequirementsKHR";
  if (const XrResult result = check_system(instance, system, call); result != XR_SUCCESS) return result;
  if (const XrResult result = check_type(out, XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR, call);
      result != XR_SUCCESS)
    return result;
  out->minApiVersionSupported = XR_MAKE_VERSION(4, 3, 0);
  out->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  runtime().asked_graphics = true;
  return XR_SUCCESS;
}

}  // namespace

void add_instance_functions(Functions& functions) {
  functions["xrEnumerateInstanceExtensionProperties"] = as_void(enumerate_extensions);
  functions["xrCreateInstance"] = as_void(create_instance);
  functions["xrDestroyInstance"] = as_void(destroy_instance);
  functions["xrGetInstanceProperties"] = as_void(get_instance_properties);
  functions["xrGetSystem"] = as_void(get_system);
  functions["xrGetSystemProperties"] = as_void(get_system_properties);
  functions["xrEnumerateViewConfigurations"] = as_void(enumerate_view_configurations);
  functions["xrEnumerateViewConfigurationViews"] = as_void(enumerate_views);
  functions["xrEnumerateEnvironmentBlendModes"] = as_void(enumerate_blend_modes);
  if (runtime().enabled.contains(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME))
    functions["xrGetOpenGLGraphicsRequirementsKHR"] = as_void(get_graphics_requirements);
}

}  // namespace simulated
