// Must precede the headers of GL.
#include <epoxy/gl.h>
#include <epoxy/glx.h>

#include "libstudy/headset/kept_context.hpp"

namespace study {

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

/// False if no context is current.
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
  // Bounded, because a lost context returns errors forever.
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

}  // namespace study
