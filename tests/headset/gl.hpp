#pragma once
/// Makes the session's context current on the calling thread. The specification (XR_KHR_opengl_enable, on
/// threads) allows a runtime to do so only in xrCreateSession, xrDestroySession, xrBeginFrame, xrEndFrame and
/// the functions of swapchains.

#include "tests/headset/state.hpp"

namespace simulated {

/// The session's context is current while the object lives. The destructor follows `leave_context` of the
/// profile: "kept" restores the previous context, as runtimes should; "none" leaves no context current, and
/// "other" one of the runtime's own, as some runtimes do. With a GLX context "other" leaves none either.
class SessionContext {
 public:
  /// Refuses if the context cannot be made current, for example because it is current on another thread.
  explicit SessionContext(const Graphics& graphics);
  ~SessionContext();
  SessionContext(const SessionContext&) = delete;
  SessionContext& operator=(const SessionContext&) = delete;

 private:
  const Graphics& graphics_;
  EGLDisplay egl_display_;
  EGLContext egl_context_;
  EGLSurface draw_, read_;
  Display* x_display_;
  GLXContext glx_context_;
  GLXDrawable drawable_;
};

/// Make and destroy the runtime's own EGL context if `leave_context` is "other".
void make_other_context(Graphics& graphics);
void destroy_other_context(Graphics& graphics);

}  // namespace simulated
