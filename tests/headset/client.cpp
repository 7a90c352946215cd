#include "tests/headset/client.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace simulated {

namespace {

PFN_xrGetInstanceProcAddr loader() {
  static void* const library = dlopen("libopenxr_loader.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::runtime_error("no libopenxr_loader.so.1; install libopenxr-loader1");
  return reinterpret_cast<PFN_xrGetInstanceProcAddr>(dlsym(library, "xrGetInstanceProcAddr"));
}

void expect(XrResult result, const char* what) {
  if (XR_FAILED(result)) throw std::runtime_error(std::string(what) + " gave " + std::to_string(result));
}

}  // namespace

Client::Client(const std::string& profile, const void* binding) : binding_(binding) {
  log_ = folder_ / "xr.log";
  ::setenv("XR_RUNTIME_JSON", VIP_BIN_DIR "/simulated_headset.json", 1);
  ::setenv("XR_LOADER_DEBUG", "none", 1);
  ::setenv("VIP_XR_PROFILE", ("size=64x48;" + profile).c_str(), 1);
  ::setenv("VIP_XR_LOG", log_.c_str(), 1);
  ::setenv("VIP_XR_DUMP", folder_.path().c_str(), 1);
  if (!binding_) {
    gl = sim::GlContext::make_headless();
    const sim::EglHandles made = gl->egl();
    egl_.getProcAddress = reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(eglGetProcAddress);
    egl_.display = made.display;
    egl_.config = made.config;
    egl_.context = made.context;
    binding_ = &egl_;
  }
  make_instance();
  make_session();
  make_swapchains();
}

Client::~Client() {
  if (gl) gl->make_current();
  if (session) call<PFN_xrDestroySession>("xrDestroySession")(session);
  if (instance) call<PFN_xrDestroyInstance>("xrDestroyInstance")(instance);
}

PFN_xrVoidFunction Client::find(const char* name) const {
  PFN_xrVoidFunction found = nullptr;
  loader()(instance, name, &found);
  return found;
}

void Client::make_instance() {
  const std::vector<const char*> extensions{
      XR_KHR_OPENGL_ENABLE_EXTENSION_NAME, XR_MNDX_EGL_ENABLE_EXTENSION_NAME,
      XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
      XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME};
  auto info = blank<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  std::strcpy(info.applicationInfo.applicationName, "test");
  info.applicationInfo.apiVersion = XR_CURRENT_API_VERSION;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.enabledExtensionNames = extensions.data();
  expect(call<PFN_xrCreateInstance>("xrCreateInstance")(&info, &instance), "xrCreateInstance");
  auto wanted = blank<XrSystemGetInfo>(XR_TYPE_SYSTEM_GET_INFO);
  wanted.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  expect(call<PFN_xrGetSystem>("xrGetSystem")(instance, &wanted, &system), "xrGetSystem");
}

void Client::make_session() {
  auto requirements = blank<XrGraphicsRequirementsOpenGLKHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  expect(call<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR")(instance, system,
                                                                                            &requirements),
         "xrGetOpenGLGraphicsRequirementsKHR");
  auto info = blank<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
  info.next = binding_;
  info.systemId = system;
  expect(call<PFN_xrCreateSession>("xrCreateSession")(instance, &info, &session), "xrCreateSession");
  local = make_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
}

XrSpace Client::make_space(XrReferenceSpaceType type) {
  auto info = blank<XrReferenceSpaceCreateInfo>(XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  info.referenceSpaceType = type;
  info.poseInReferenceSpace.orientation.w = 1;
  XrSpace space = XR_NULL_HANDLE;
  expect(call<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace")(session, &info, &space),
         "xrCreateReferenceSpace");
  return space;
}

void Client::make_swapchains(std::int64_t format, std::uint32_t array) {
  std::uint32_t count = 0;
  std::array<XrViewConfigurationView, 2> views;
  views.fill(blank<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW));
  expect(call<PFN_xrEnumerateViewConfigurationViews>("xrEnumerateViewConfigurationViews")(
             instance, system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 2, &count, views.data()),
         "xrEnumerateViewConfigurationViews");
  width = views[0].recommendedImageRectWidth;
  height = views[0].recommendedImageRectHeight;
  auto info = blank<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
  info.format = format;
  info.width = width;
  info.height = height;
  info.sampleCount = info.faceCount = info.mipCount = 1;
  info.arraySize = array;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    expect(call<PFN_xrCreateSwapchain>("xrCreateSwapchain")(session, &info, &swapchains[eye]),
           "xrCreateSwapchain");
    const auto list = call<PFN_xrEnumerateSwapchainImages>("xrEnumerateSwapchainImages");
    expect(list(swapchains[eye], 0, &count, nullptr), "xrEnumerateSwapchainImages");
    images[eye].assign(count, blank<XrSwapchainImageOpenGLKHR>(XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR));
    expect(list(swapchains[eye], count, &count,
                reinterpret_cast<XrSwapchainImageBaseHeader*>(images[eye].data())),
           "xrEnumerateSwapchainImages");
  }
}

void Client::poll() {
  while (true) {
    auto event = blank<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
    if (call<PFN_xrPollEvent>("xrPollEvent")(instance, &event) != XR_SUCCESS) return;
    if (event.type != XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
      events.push_back(event);
      continue;
    }
    session_state = reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state;
    states.push_back(session_state);
    if (session_state == XR_SESSION_STATE_READY) {
      auto info = blank<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
      info.primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
      expect(call<PFN_xrBeginSession>("xrBeginSession")(session, &info), "xrBeginSession");
      running = true;
    }
    if (session_state == XR_SESSION_STATE_STOPPING) {
      expect(call<PFN_xrEndSession>("xrEndSession")(session), "xrEndSession");
      running = false;
    }
  }
}

XrResult Client::frame(const Spoil& spoil) {
  poll();
  if (!running) return XR_ERROR_SESSION_NOT_RUNNING;
  if (const XrResult result = wait(); XR_FAILED(result)) return result;
  if (const XrResult result = begin(); XR_FAILED(result)) return result;
  return end(spoil);
}

void Client::frames_until(XrSessionState wanted) {
  for (int i = 0; i < 100 && session_state != wanted; ++i) frame();
  ASSERT_EQ(session_state, wanted);
}

void Client::draw(int eye, const std::array<float, 4>& colour) {
  const auto at = static_cast<std::size_t>(eye);
  std::uint32_t index = 0;
  expect(call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage")(swapchains[at], nullptr, &index),
         "xrAcquireSwapchainImage");
  auto info = blank<XrSwapchainImageWaitInfo>(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
  info.timeout = XR_INFINITE_DURATION;
  XrResult result = XR_TIMEOUT_EXPIRED;
  while (result == XR_TIMEOUT_EXPIRED)
    result = call<PFN_xrWaitSwapchainImage>("xrWaitSwapchainImage")(swapchains[at], &info);
  expect(result, "xrWaitSwapchainImage");
  if (gl) gl->make_current();
  glClearTexSubImage(images[at][index].image, 0, 0, 0, 0, static_cast<GLsizei>(width),
                     static_cast<GLsizei>(height), 1, GL_RGBA, GL_FLOAT, colour.data());
  expect(call<PFN_xrReleaseSwapchainImage>("xrReleaseSwapchainImage")(swapchains[at], nullptr),
         "xrReleaseSwapchainImage");
}

XrResult Client::locate(std::array<XrView, 2>& views, XrViewState& view_state) {
  auto info = blank<XrViewLocateInfo>(XR_TYPE_VIEW_LOCATE_INFO);
  info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  info.displayTime = state.predictedDisplayTime;
  info.space = local;
  view_state = blank<XrViewState>(XR_TYPE_VIEW_STATE);
  views.fill(blank<XrView>(XR_TYPE_VIEW));
  std::uint32_t count = 0;
  return call<PFN_xrLocateViews>("xrLocateViews")(session, &info, &view_state, 2, &count, views.data());
}

XrSpaceLocation Client::locate(XrSpace what, XrSpace from, XrTime time, void* next) {
  auto out = blank<XrSpaceLocation>(XR_TYPE_SPACE_LOCATION);
  out.next = next;
  expect(call<PFN_xrLocateSpace>("xrLocateSpace")(what, from, time, &out), "xrLocateSpace");
  return out;
}

XrResult Client::end(const Spoil& spoil) {
  Drawing drawing;
  drawing.end = blank<XrFrameEndInfo>(XR_TYPE_FRAME_END_INFO);
  drawing.end.displayTime = state.predictedDisplayTime;
  drawing.end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  std::array<XrView, 2> views;
  XrViewState view_state;
  if (const XrResult result = locate(views, view_state); XR_FAILED(result)) return result;
  drawing.projection = blank<XrCompositionLayerProjection>(XR_TYPE_COMPOSITION_LAYER_PROJECTION);
  drawing.projection.space = local;
  drawing.projection.viewCount = 2;
  drawing.projection.views = drawing.views.data();
  for (std::size_t eye = 0; eye < 2; ++eye) {
    auto& view = drawing.views[eye];
    view = blank<XrCompositionLayerProjectionView>(XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
    view.pose = views[eye].pose;
    view.fov = views[eye].fov;
    view.subImage.swapchain = swapchains[eye];
    view.subImage.imageRect.extent = {static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
  }
  const bool valid = view_state.viewStateFlags & XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  if (state.shouldRender && valid) {
    draw(0);
    draw(1);
    drawing.layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&drawing.projection));
  }
  if (spoil) spoil(drawing);
  drawing.end.layerCount = static_cast<std::uint32_t>(drawing.layers.size());
  drawing.end.layers = drawing.layers.data();
  return call<PFN_xrEndFrame>("xrEndFrame")(session, &drawing.end);
}

std::string read_text(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

std::string Client::log() const { return read_text(log_); }

std::vector<std::string> Client::lines(const std::string& start) const {
  std::vector<std::string> out;
  std::istringstream in(log());
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(start)) out.push_back(line);
  }
  return out;
}

}  // namespace simulated
