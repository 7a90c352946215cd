#pragma once
/// Makes the session's context current on the calling thread. The specification (XR_KHR_opengl_enable, on
/// threads) allows a runtime to do so only in xrCreateSession, xrDestroySession, xrBeginFrame, xrEndFrame and
/// the functions of swapchains.

#include "tests/headset/state.hpp"

namespace simulated {

/// Current while the object lives. Afterwards the profile decides: the previous context, as runtimes should
/// leave it, or no context or one of the runtime's own, as some do.
class SessionContext {
 public:
  /// Refuses if the context is current on another thread.
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

/// Makes and destroys the runtime's own context, if the profile asks for one.
void make_other_context(Graphics& graphics);
void destroy_other_context(Graphics& graphics);

}  // namespace simulated
