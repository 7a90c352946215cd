/// Sessions, as far as they are asked before they begin.

#include <algorithm>

#include "tests/headset/state.hpp"

namespace simulated {

XrResult check_session(XrSession session, const char* call) {
  log_line(call);
  if (runtime().sessions.contains(number_of(session))) return XR_SUCCESS;
  breach(std::string(call) + ": the session is not alive");
  return XR_ERROR_HANDLE_INVALID;
}

namespace {

/// A runtime that is about to go says so with a success.
XrResult done() { return runtime().profile.positive ? XR_SESSION_LOSS_PENDING : XR_SUCCESS; }

const XrGraphicsBindingEGLMNDX* egl_binding(const void* next) {
  for (auto* one = static_cast<const XrBaseInStructure*>(next); one; one = one->next) {
    if (one->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX)
      return reinterpret_cast<const XrGraphicsBindingEGLMNDX*>(one);
  }
  return nullptr;
}

XRAPI_ATTR XrResult XRAPI_CALL create_session(XrInstance instance, const XrSessionCreateInfo* info,
                                              XrSession* session) {
  constexpr const char* call = "xrCreateSession";
  if (const XrResult result = check_instance(instance, call); result != XR_SUCCESS) return result;
  if (const XrResult result = check_type(info, XR_TYPE_SESSION_CREATE_INFO, call); result != XR_SUCCESS)
    return result;
  if (const XrResult result = check_system(instance, info->systemId, call); result != XR_SUCCESS)
    return result;
  Runtime& all = runtime();
  if (!all.asked_graphics) {
    breach("xrCreateSession: the graphics requirements were not asked for");
    return XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING;
  }
  const auto* binding = egl_binding(info->next);
  if (!binding || !all.enabled.contains(XR_MNDX_EGL_ENABLE_EXTENSION_NAME)) {
    breach("xrCreateSession: no graphics binding of an enabled extension");
    return XR_ERROR_GRAPHICS_DEVICE_INVALID;
  }
  if (!binding->getProcAddress || !binding->display || !binding->context) {
    breach("xrCreateSession: a binding without display, context or functions");
    return XR_ERROR_GRAPHICS_DEVICE_INVALID;
  }
  if (!all.sessions.empty()) {
    breach("xrCreateSession: there is a session already");
    return XR_ERROR_LIMIT_REACHED;
  }
  *session = new_handle<XrSession>(all.sessions);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroy_session(XrSession session) {
  if (const XrResult result = check_session(session, "xrDestroySession"); result != XR_SUCCESS) return result;
  runtime().sessions.erase(number_of(session));
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_formats(XrSession session, std::uint32_t capacity,
                                                 std::uint32_t* count, std::int64_t* out) {
  constexpr const char* call = "xrEnumerateSwapchainFormats";
  if (const XrResult result = check_session(session, call); result != XR_SUCCESS) return result;
  const XrResult result = give_values(runtime().profile.formats, capacity, count, out, call);
  return result == XR_SUCCESS ? done() : result;
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_rates(XrSession session, std::uint32_t capacity,
                                               std::uint32_t* count, float* out) {
  constexpr const char* call = "xrEnumerateDisplayRefreshRatesFB";
  if (const XrResult result = check_session(session, call); result != XR_SUCCESS) return result;
  const XrResult result = give_values(runtime().profile.rates, capacity, count, out, call);
  return result == XR_SUCCESS ? done() : result;
}

XRAPI_ATTR XrResult XRAPI_CALL get_rate(XrSession session, float* out) {
  if (const XrResult result = check_session(session, "xrGetDisplayRefreshRateFB"); result != XR_SUCCESS)
    return result;
  *out = runtime().profile.rate;
  return done();
}

}  // namespace

void add_session_functions(Functions& functions) {
  functions["xrCreateSession"] = as_void(create_session);
  functions["xrDestroySession"] = as_void(destroy_session);
  functions["xrEnumerateSwapchainFormats"] = as_void(enumerate_formats);
  if (!runtime().enabled.contains(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return;
  functions["xrEnumerateDisplayRefreshRatesFB"] = as_void(enumerate_rates);
  functions["xrGetDisplayRefreshRateFB"] = as_void(get_rate);
}

}  // namespace simulated
