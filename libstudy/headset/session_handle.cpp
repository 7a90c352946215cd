// epoxy must come first. Only this file includes X together with OpenXR, because X's macros clash with other
// code.
#include <epoxy/gl.h>
#include <epoxy/glx.h>
#define XR_USE_PLATFORM_XLIB

#include "libstudy/headset/session_handle.hpp"

#include <fmt/format.h>

#include <utility>

#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr XrPosef no_offset{{0, 0, 0, 1}, {0, 0, 0}};

// Views and spaces use the same validity bits.
static_assert(XR_SPACE_LOCATION_POSITION_TRACKED_BIT == XR_VIEW_STATE_POSITION_TRACKED_BIT);
static_assert(XR_SPACE_LOCATION_ORIENTATION_VALID_BIT == XR_VIEW_STATE_ORIENTATION_VALID_BIT);

/// Checks the version of OpenGL. The specification requires this query before a session is made.
void check_graphics(const XrConnection& xr, XrSystemId system) {
  XrGraphicsRequirementsOpenGLKHR needs{};
  needs.type = XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR;
  check_xr(xr.function<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR")(
               xr.instance(), system, &needs),
           "xrGetOpenGLGraphicsRequirementsKHR");
  const int version = epoxy_gl_version();
  if (XR_MAKE_VERSION(version / 10, version % 10, 0xffffffff) >= needs.minApiVersionSupported) return;
  throw base::Error("OpenXR",
                    fmt::format("the runtime needs OpenGL {}.{}, the driver has {}.{}",
                                XR_VERSION_MAJOR(needs.minApiVersionSupported),
                                XR_VERSION_MINOR(needs.minApiVersionSupported), version / 10, version % 10),
                    "update the graphics driver");
}

XrGraphicsBindingEGLMNDX egl_binding(const sim::EglHandles& egl) {
  XrGraphicsBindingEGLMNDX out{};
  out.type = XR_TYPE_GRAPHICS_BINDING_EGL_MNDX;
  out.getProcAddress = reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(eglGetProcAddress);
  out.display = egl.display;
  out.config = egl.config;
  out.context = egl.context;
  return out;
}

XrGraphicsBindingOpenGLXlibKHR xlib_binding(const sim::GlxHandles& glx) {
  XrGraphicsBindingOpenGLXlibKHR out{};
  out.type = XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR;
  out.xDisplay = static_cast<Display*>(glx.display);
  out.visualid = glx.visual;
  out.glxFBConfig = static_cast<GLXFBConfig>(glx.config);
  out.glxDrawable = glx.drawable;
  out.glxContext = static_cast<GLXContext>(glx.context);
  return out;
}

}  // namespace

KeptContext::KeptContext(bool on_x)
    : on_x_(on_x),
      api_(eglQueryAPI()),
      display_(eglGetCurrentDisplay()),
      context_(eglGetCurrentContext()),
      draw_(eglGetCurrentSurface(EGL_DRAW)),
      read_(eglGetCurrentSurface(EGL_READ)) {
  if (!on_x) return;
  x_display_ = glXGetCurrentDisplay();
  x_context_ = glXGetCurrentContext();
  x_drawable_ = glXGetCurrentDrawable();
}

void KeptContext::take_back_egl() const {
  eglBindAPI(api_);
  const bool same = eglGetCurrentContext() == context_ && eglGetCurrentSurface(EGL_DRAW) == draw_ &&
                    eglGetCurrentSurface(EGL_READ) == read_;
  if (!same && context_ != EGL_NO_CONTEXT) eglMakeCurrent(display_, draw_, read_, context_);
  if (!same && context_ == EGL_NO_CONTEXT)
    eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/// Makes the GLX context of the constructor current again. Returns false if there was none.
bool KeptContext::take_back_glx() const {
  const auto context = static_cast<GLXContext>(x_context_);
  if (glXGetCurrentContext() == context && glXGetCurrentDrawable() == x_drawable_) return context;
  if (context) {
    glXMakeCurrent(static_cast<::Display*>(x_display_), x_drawable_, context);
  } else if (::Display* other = glXGetCurrentDisplay()) {
    glXMakeCurrent(other, 0, nullptr);
  }
  return context;
}

KeptContext::~KeptContext() {
  if (!on_x_) take_back_egl();
  const bool current = on_x_ ? take_back_glx() : context_ != EGL_NO_CONTEXT;
  if (!current) return;
  // Clears OpenGL errors. The loop is bounded, because a lost context returns errors forever.
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

SessionHandle::SessionHandle(const XrConnection& xr, XrSystemId system, const sim::GlContext& gl)
    : xr_(xr), on_x_(gl.glx().display != nullptr) {
  check_graphics(xr, system);
  const XrGraphicsBindingEGLMNDX egl = egl_binding(gl.egl());
  const XrGraphicsBindingOpenGLXlibKHR xlib = xlib_binding(gl.glx());
  XrSessionCreateInfo info{};
  info.type = XR_TYPE_SESSION_CREATE_INFO;
  info.next = on_x_ ? static_cast<const void*>(&xlib) : &egl;
  info.systemId = system;
  check_xr(attempt<PFN_xrCreateSession>("xrCreateSession", xr.instance(), &info, &session_),
           "xrCreateSession", "see the runtime's log: it may serve another GPU than this program's");
}

SessionHandle::~SessionHandle() { destroy<PFN_xrDestroySession>("xrDestroySession", session_); }

std::vector<std::int64_t> SessionHandle::formats() const {
  return read_array<std::int64_t>("xrEnumerateSwapchainFormats", 0,
                                  [&](auto capacity, auto* count, auto* values) {
                                    return attempt<PFN_xrEnumerateSwapchainFormats>(
                                        "xrEnumerateSwapchainFormats", session_, capacity, count, values);
                                  });
}

Space::Space(const SessionHandle& session, XrReferenceSpaceType kind) : session_(session) {
  XrReferenceSpaceCreateInfo info{};
  info.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO;
  info.referenceSpaceType = kind;
  info.poseInReferenceSpace = no_offset;
  session.call<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace", session.get(), &info, &space_);
}

Space::Space(const SessionHandle& session, XrAction pose, XrPath hand) : session_(session) {
  XrActionSpaceCreateInfo info{};
  info.type = XR_TYPE_ACTION_SPACE_CREATE_INFO;
  info.action = pose;
  info.subactionPath = hand;
  info.poseInActionSpace = no_offset;
  session.call<PFN_xrCreateActionSpace>("xrCreateActionSpace", session.get(), &info, &space_);
}

Space::Space(Space&& other) noexcept
    : session_(other.session_), space_(std::exchange(other.space_, XR_NULL_HANDLE)) {}

Space::~Space() { session_.destroy<PFN_xrDestroySpace>("xrDestroySpace", space_); }

HeadsetPose Space::locate(const Space& base, XrTime time, void* next) const {
  XrSpaceLocation found{};
  found.type = XR_TYPE_SPACE_LOCATION;
  found.next = next;
  session_.call<PFN_xrLocateSpace>("xrLocateSpace", space_, base.get(), time, &found);
  return pose_of(found.pose, found.locationFlags);
}

HeadsetPose pose_of(const XrPosef& pose, XrFlags64 flags) {
  HeadsetPose out;
  out.place_valid = flags & XR_SPACE_LOCATION_POSITION_VALID_BIT;
  out.turn_valid = flags & XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  out.place_tracked = flags & XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
  out.turn_tracked = flags & XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
  // Copies valid parts only: invalid parts may have any values.
  if (out.place_valid) out.place_m = {pose.position.x, pose.position.y, pose.position.z};
  if (out.turn_valid)
    out.turn = {pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w};
  return out;
}

XrPosef pose_of(const HeadsetPose& pose) {
  return {{pose.turn[0], pose.turn[1], pose.turn[2], pose.turn[3]},
          {pose.place_m[0], pose.place_m[1], pose.place_m[2]}};
}

}  // namespace study
