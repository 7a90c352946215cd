#include "apps/common/headset/offer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/common/headset/loader.hpp"
#include "libsim/render/gl_context.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

constexpr XrViewConfigurationType stereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

XrSystemId find_system(const XrConnection& xr) {
  XrSystemGetInfo info{};
  info.type = XR_TYPE_SYSTEM_GET_INFO;
  info.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  const XrResult result = xr.function<PFN_xrGetSystem>("xrGetSystem")(xr.instance(), &info, &system);
  if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE) {
    throw base::Error("OpenXR", "the runtime answers, and no headset is connected to it",
                      "connect the headset, switch it on, and try again");
  }
  if (result == XR_ERROR_FORM_FACTOR_UNSUPPORTED) {
    throw base::Error("OpenXR", "the runtime knows no headsets", "use a runtime for head-mounted displays");
  }
  check_xr(result, "xrGetSystem");
  return system;
}

void read_runtime(const XrConnection& xr, HeadsetOffer& out) {
  XrInstanceProperties found{};
  found.type = XR_TYPE_INSTANCE_PROPERTIES;
  check_xr(xr.function<PFN_xrGetInstanceProperties>("xrGetInstanceProperties")(xr.instance(), &found),
           "xrGetInstanceProperties");
  out.runtime = found.runtimeName;
  out.runtime_version =
      fmt::format("{}.{}.{}", XR_VERSION_MAJOR(found.runtimeVersion), XR_VERSION_MINOR(found.runtimeVersion),
                  XR_VERSION_PATCH(found.runtimeVersion));
  out.extensions = xr.offered();
  std::sort(out.extensions.begin(), out.extensions.end());
  out.time_converts = xr.has(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME);
}

void read_system(const XrConnection& xr, XrSystemId system, HeadsetOffer& out) {
  XrSystemEyeGazeInteractionPropertiesEXT gaze{};
  gaze.type = XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT;
  XrSystemProperties found{};
  found.type = XR_TYPE_SYSTEM_PROPERTIES;
  const bool asks_gaze = xr.has(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  if (asks_gaze) found.next = &gaze;
  check_xr(xr.function<PFN_xrGetSystemProperties>("xrGetSystemProperties")(xr.instance(), system, &found),
           "xrGetSystemProperties");
  out.headset = found.systemName;
  out.position = found.trackingProperties.positionTracking;
  out.eye_gaze = asks_gaze && gaze.supportsEyeGazeInteraction;
}

void read_views(const XrConnection& xr, XrSystemId system, HeadsetOffer& out) {
  const auto list = xr.function<PFN_xrEnumerateViewConfigurations>("xrEnumerateViewConfigurations");
  const auto kinds = read_array<XrViewConfigurationType>(
      "xrEnumerateViewConfigurations", stereo, [&](auto capacity, auto* count, auto* values) {
        return list(xr.instance(), system, capacity, count, values);
      });
  if (std::find(kinds.begin(), kinds.end(), stereo) == kinds.end()) {
    throw base::Error("OpenXR", "the headset does not show a picture to each of two eyes",
                      "use a headset with two views");
  }
  XrViewConfigurationView blank{};
  blank.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  const auto views = xr.function<PFN_xrEnumerateViewConfigurationViews>("xrEnumerateViewConfigurationViews");
  for (const auto& view : read_array<XrViewConfigurationView>(
           "xrEnumerateViewConfigurationViews", blank, [&](auto capacity, auto*count, auto*values) {
             return views(xr.instance(), system, stereo, capacity, count, values);
           }))
    out.eyes.push_back({view.recommendedImageRectWidth, view.recommendedImageRectHeight});
  const auto blends = xr.function<PFN_xrEnumerateEnvironmentBlendModes>("xrEnumerateEnvironmentBlendModes");
  const auto modes = read_array<XrEnvironmentBlendMode>(
      "xrEnumerateEnvironmentBlendModes", XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
      [&](auto capacity, auto* count, auto* values) {
        return blends(xr.instance(), system, stereo, capacity, count, values);
      });
  out.opaque = std::find(modes.begin(), modes.end(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE) != modes.end();
}

/// A session that is never begun: it shows nothing and needs no frames.
class AskingSession {
 public:
  AskingSession(const XrConnection& xr, XrSystemId system) : xr_(xr), gl_(sim::GlContext::make_headless()) {
    XrGraphicsRequirementsOpenGLKHR requirements{};
    requirements.type = XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR;
    check_xr(xr.function<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR")(
                 xr.instance(), system, &requirements),
             "xrGetOpenGLGraphicsRequirementsKHR");
    const sim::EglHandles egl = gl_.egl();
    XrGraphicsBindingEGLMNDX binding{};
    binding.type = XR_TYPE_GRAPHICS_BINDING_EGL_MNDX;
    binding.getProcAddress = reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(eglGetProcAddress);
    binding.display = egl.display;
    binding.config = egl.config;
    binding.context = egl.context;
    XrSessionCreateInfo info{};
    info.type = XR_TYPE_SESSION_CREATE_INFO;
    info.next = &binding;
    info.systemId = system;
    check_xr(xr.function<PFN_xrCreateSession>("xrCreateSession")(xr.instance(), &info, &session_),
             "xrCreateSession", "see the runtime's log: it may serve another GPU than this program's");
  }
  ~AskingSession() { xr_.function<PFN_xrDestroySession>("xrDestroySession")(session_); }
  AskingSession(const AskingSession&) = delete;
  AskingSession& operator=(const AskingSession&) = delete;

  std::vector<std::int64_t> formats() const {
    const auto list = xr_.function<PFN_xrEnumerateSwapchainFormats>("xrEnumerateSwapchainFormats");
    return read_array<std::int64_t>(
        "xrEnumerateSwapchainFormats", 0,
        [&](auto capacity, auto* count, auto* values) { return list(session_, capacity, count, values); });
  }

  std::vector<double> refresh_rates() const {
    if (!xr_.has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return {};
    const auto list = xr_.function<PFN_xrEnumerateDisplayRefreshRatesFB>("xrEnumerateDisplayRefreshRatesFB");
    const auto rates = read_array<float>(
        "xrEnumerateDisplayRefreshRatesFB", 0.0f,
        [&](auto capacity, auto* count, auto* values) { return list(session_, capacity, count, values); });
    std::vector<double> out(rates.begin(), rates.end());
    std::sort(out.begin(), out.end());
    return out;
  }

  double refresh_now() const {
    float rate = 0;
    check_xr(xr_.function<PFN_xrGetDisplayRefreshRateFB>("xrGetDisplayRefreshRateFB")(session_, &rate),
             "xrGetDisplayRefreshRateFB");
    return static_cast<double>(rate);
  }

 private:
  const XrConnection& xr_;
  sim::GlContext gl_;
  XrSession session_ = XR_NULL_HANDLE;
};

void read_in_session(const XrConnection& xr, XrSystemId system, HeadsetOffer& out) {
  if (!xr.has(XR_MNDX_EGL_ENABLE_EXTENSION_NAME)) {
    out.no_session = "the runtime does not offer " XR_MNDX_EGL_ENABLE_EXTENSION_NAME;
    return;
  }
  const AskingSession session(xr, system);
  HeadsetOffer::InSession found;
  found.formats = session.formats();
  found.refresh_hz = session.refresh_rates();
  // Some runtimes answer with a rate that they do not have while they list one only.
  if (found.refresh_hz.size() > 1) found.refresh_now = session.refresh_now();
  out.session = found;
}

}  // namespace

HeadsetOffer read_headset_offer() {
  const XrConnection xr(
      {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME},
      {XR_MNDX_EGL_ENABLE_EXTENSION_NAME, XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME,
       XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME});
  HeadsetOffer out;
  read_runtime(xr, out);
  const XrSystemId system = find_system(xr);
  read_system(xr, system, out);
  read_views(xr, system, out);
  read_in_session(xr, system, out);
  return out;
}

std::string gl_format_name(std::int64_t format) {
  switch (format) {
    case GL_SRGB8_ALPHA8:
      return "GL_SRGB8_ALPHA8";
    case GL_SRGB8:
      return "GL_SRGB8";
    case GL_RGBA8:
      return "GL_RGBA8";
    case GL_RGB10_A2:
      return "GL_RGB10_A2";
    case GL_RGBA16:
      return "GL_RGBA16";
    case GL_RGBA16F:
      return "GL_RGBA16F";
    case GL_RGB16F:
      return "GL_RGB16F";
    case GL_R11F_G11F_B10F:
      return "GL_R11F_G11F_B10F";
    case GL_DEPTH_COMPONENT16:
      return "GL_DEPTH_COMPONENT16";
    case GL_DEPTH_COMPONENT24:
      return "GL_DEPTH_COMPONENT24";
    case GL_DEPTH_COMPONENT32F:
      return "GL_DEPTH_COMPONENT32F";
    case GL_DEPTH24_STENCIL8:
      return "GL_DEPTH24_STENCIL8";
    case GL_DEPTH32F_STENCIL8:
      return "GL_DEPTH32F_STENCIL8";
    default:
      return fmt::format("0x{:x}", format);
  }
}

}  // namespace apps
