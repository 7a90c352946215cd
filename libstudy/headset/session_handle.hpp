#pragma once
/// OpenXR's session on an OpenGL context. Calls into the session preserve the caller's OpenGL context.

#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libstudy/headset/openxr.hpp"
#include "libstudy/headset/system.hpp"
#include "libstudy/headset/views.hpp"

namespace study {

/// Restores the calling thread's OpenGL context after a call into the runtime, because runtimes make other
/// contexts current and leave OpenGL errors behind. The destructor makes the context of the constructor
/// current again and clears its errors.
class KeptContext {
 public:
  /// on_x: true for a GLX context, false for an EGL context.
  explicit KeptContext(bool on_x);
  ~KeptContext();
  KeptContext(const KeptContext&) = delete;
  KeptContext& operator=(const KeptContext&) = delete;

 private:
  void take_back_egl() const;
  bool take_back_glx() const;

  bool on_x_;
  void* x_display_ = nullptr;
  void* x_context_ = nullptr;
  unsigned long x_drawable_ = 0;
  EGLenum api_;
  EGLDisplay display_;
  EGLContext context_;
  EGLSurface draw_, read_;
};

/// An OpenXR session. The destructor destroys the session; destroy objects made from the session before.
class SessionHandle {
 public:
  /// base::Error if the runtime needs a newer OpenGL, or refuses this context or contexts of its kind. `gl`
  /// must be current on the calling thread and outlive the session.
  SessionHandle(const XrConnection& xr, XrSystemId system, const sim::GlContext& gl);
  ~SessionHandle();
  SessionHandle(const SessionHandle&) = delete;
  SessionHandle& operator=(const SessionHandle&) = delete;

  XrSession get() const { return session_; }
  const XrConnection& xr() const { return xr_; }

  /// Calls an OpenXR function: call<PFN_xrEndSession>("xrEndSession", session). Returns its success code;
  /// base::Error for a failure.
  template <class F, class... Arguments>
  XrResult call(const char* name, Arguments... arguments) const {
    const XrResult result = attempt<F>(name, arguments...);
    check_xr(result, name);
    return result;
  }
  /// As call(), but returns a failure instead of throwing.
  template <class F, class... Arguments>
  XrResult attempt(const char* name, Arguments... arguments) const {
    const F function = xr_.function<F>(name);
    const KeptContext kept(on_x_);
    return function(arguments...);
  }
  /// Destroys an object made from the session; does nothing after leave_behind().
  template <class F, class Handle>
  void destroy(const char* name, Handle handle) const {
    if (handle != XR_NULL_HANDLE && !left_behind_) attempt<F>(name, handle);
  }
  /// Call it if a call into the runtime does not return: the session's objects must not be used any more, and
  /// exist until the process ends.
  void leave_behind() { left_behind_ = true; }

  /// GL internal formats for pictures, in the runtime's order of preference.
  std::vector<std::int64_t> formats() const;

 private:
  const XrConnection& xr_;
  XrSession session_ = XR_NULL_HANDLE;
  bool on_x_;
  bool left_behind_ = false;
};

/// An OpenXR space (frame of reference) of the session. The destructor destroys it.
class Space {
 public:
  Space(const SessionHandle& session, XrReferenceSpaceType kind);
  Space(const SessionHandle& session, XrAction pose, XrPath hand = XR_NULL_PATH);
  ~Space();
  Space(Space&& other) noexcept;
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;
  Space& operator=(Space&&) = delete;

  XrSpace get() const { return space_; }
  /// The pose of this space in `base` at `time`. `next`: structure to chain to the result structure.
  HeadsetPose locate(const Space& base, XrTime time, void* next = nullptr) const;

 private:
  const SessionHandle& session_;
  XrSpace space_ = XR_NULL_HANDLE;
};

/// Conversions between OpenXR's poses and HeadsetPose.
HeadsetPose pose_of(const XrPosef& pose, XrFlags64 flags);
XrPosef pose_of(const HeadsetPose& pose);

}  // namespace study
