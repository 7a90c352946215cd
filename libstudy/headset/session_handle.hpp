#pragma once
/// OpenXR's session on a GL context, and calls into it that preserve the caller's GL context.

#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libstudy/headset/openxr.hpp"
#include "libstudy/headset/system.hpp"
#include "libstudy/headset/views.hpp"

namespace study {

/// Restores the calling thread's GL context after a call into the runtime.
///
/// Runtimes make their own contexts current and leave GL errors behind. The destructor makes the context
/// current that was current at construction, and clears its errors.
class KeptContext {
 public:
  /// on_x: the context is GLX's; otherwise EGL's.
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

/// The destructor destroys the session; everything made from it must be destroyed before.
class SessionHandle {
 public:
  /// base::Error if the runtime does not take contexts of this kind, or this one. `gl` is current on the
  /// calling thread and outlives the session.
  SessionHandle(const XrConnection& xr, XrSystemId system, const sim::GlContext& gl);
  ~SessionHandle();
  SessionHandle(const SessionHandle&) = delete;
  SessionHandle& operator=(const SessionHandle&) = delete;

  XrSession get() const { return session_; }
  const XrConnection& xr() const { return xr_; }

  /// call<PFN_xrEndSession>("xrEndSession", session): base::Error for a failure; returns the success code.
  template <class F, class... Arguments>
  XrResult call(const char* name, Arguments... arguments) const {
    const XrResult result = attempt<F>(name, arguments...);
    check_xr(result, name);
    return result;
  }
  /// The same, but also returns failures.
  template <class F, class... Arguments>
  XrResult attempt(const char* name, Arguments... arguments) const {
    const F function = xr_.function<F>(name);
    const KeptContext kept(on_x_);
    return function(arguments...);
  }
  /// Destroys an object made from the session, unless the session was left behind.
  template <class F, class Handle>
  void destroy(const char* name, Handle handle) const {
    if (handle != XR_NULL_HANDLE && !left_behind_) attempt<F>(name, handle);
  }
  /// For a call that never returned: nothing of the session may be touched any more. It stays until the
  /// process ends.
  void leave_behind() { left_behind_ = true; }

  /// GL internal formats for pictures, in the runtime's order of preference.
  std::vector<std::int64_t> formats() const;

 private:
  const XrConnection& xr_;
  XrSession session_ = XR_NULL_HANDLE;
  bool on_x_;
  bool left_behind_ = false;
};

/// A space of the session; destroyed with the object.
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
  /// Its pose in `base`; `next` is chained to the result structure.
  HeadsetPose locate(const Space& base, XrTime time, void* next = nullptr) const;

 private:
  const SessionHandle& session_;
  XrSpace space_ = XR_NULL_HANDLE;
};

/// Conversions between OpenXR's poses and ours.
HeadsetPose pose_of(const XrPosef& pose, XrFlags64 flags);
XrPosef pose_of(const HeadsetPose& pose);

}  // namespace study
