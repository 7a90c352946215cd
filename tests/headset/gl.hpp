#pragma once
/// The session's context on the calling thread. The specification (XR_KHR_opengl_enable, on threads) lets a
/// runtime take it in xrCreateSession, xrDestroySession, xrBeginFrame, xrEndFrame and the functions of
/// swapchains, and in no other.

#include "tests/headset/state.hpp"

namespace simulated {

/// Current while the object lives; then the profile says what is: what was current before, as runtimes ought
/// to leave it, or no context or one of the runtime's own, as some do.
class SessionContext {
 public:
  /// Refuses when the context is current on another thread.
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

/// The runtime's own context, where the profile asks for one.
void make_other_context(Graphics& graphics);
void destroy_other_context(Graphics& graphics);

}  // namespace simulated
