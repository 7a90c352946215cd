#include "tests/headset/gl.hpp"

namespace simulated {

namespace {

constexpr const char* elsewhere =
    "the session's context cannot be made current: another thread holds it, or it is gone";

void leave_error() {
  if (runtime().profile.leave_error) glEnable(GL_TEXTURE_2D + 0x7000);  // no such capability: GL_INVALID_ENUM
}

}  // namespace

SessionContext::SessionContext(const Graphics& graphics)
    : graphics_(graphics),
      egl_display_(eglGetCurrentDisplay()),
      egl_context_(eglGetCurrentContext()),
      draw_(eglGetCurrentSurface(EGL_DRAW)),
      read_(eglGetCurrentSurface(EGL_READ)),
      x_display_(nullptr),
      glx_context_(nullptr),
      drawable_(0) {
  if (graphics.glx_context) {
    x_display_ = glXGetCurrentDisplay();
    glx_context_ = glXGetCurrentContext();
    drawable_ = glXGetCurrentDrawable();
    if (glx_context_ == graphics.glx_context) return;
    need(glXMakeCurrent(graphics.x_display, graphics.drawable, graphics.glx_context),
         XR_ERROR_RUNTIME_FAILURE, elsewhere);
    return;
  }
  if (egl_context_ == graphics.egl_context) return;
  need(eglMakeCurrent(graphics.egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, graphics.egl_context),
       XR_ERROR_RUNTIME_FAILURE, elsewhere);
}

SessionContext::~SessionContext() {
  leave_error();
  const std::string& leave = runtime().profile.leave_context;
  if (graphics_.glx_context) {
    if (leave != "kept") glXMakeCurrent(graphics_.x_display, 0, nullptr);
    if (leave == "kept" && glx_context_ != graphics_.glx_context)
      glXMakeCurrent(graphics_.x_display, drawable_, glx_context_);
    return;
  }
  const EGLDisplay display = graphics_.egl_display;
  if (leave == "none") eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (leave == "other") eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, graphics_.other_context);
  if (leave != "kept" || egl_context_ == graphics_.egl_context) return;
  if (egl_context_ == EGL_NO_CONTEXT) {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  } else {
    eglMakeCurrent(egl_display_, draw_, read_, egl_context_);
  }
}

void make_other_context(Graphics& graphics) {
  if (runtime().profile.leave_context != "other" || !graphics.egl_context) return;
  eglBindAPI(EGL_OPENGL_API);
  graphics.other_context =
      eglCreateContext(graphics.egl_display, graphics.egl_config, EGL_NO_CONTEXT, nullptr);
  if (graphics.other_context == EGL_NO_CONTEXT) fail(XR_ERROR_RUNTIME_FAILURE);
}

void destroy_other_context(Graphics& graphics) {
  if (graphics.other_context == EGL_NO_CONTEXT) return;
  if (eglGetCurrentContext() == graphics.other_context)
    eglMakeCurrent(graphics.egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(graphics.egl_display, graphics.other_context);
  graphics.other_context = EGL_NO_CONTEXT;
}

}  // namespace simulated
