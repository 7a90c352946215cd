#include "apps/common/headset/kept_context.hpp"

namespace apps {

KeptContext::KeptContext()
    : api_(eglQueryAPI()),
      display_(eglGetCurrentDisplay()),
      context_(eglGetCurrentContext()),
      draw_(eglGetCurrentSurface(EGL_DRAW)),
      read_(eglGetCurrentSurface(EGL_READ)) {}

KeptContext::~KeptContext() {
  eglBindAPI(api_);
  const bool same = eglGetCurrentContext() == context_ && eglGetCurrentSurface(EGL_DRAW) == draw_ &&
                    eglGetCurrentSurface(EGL_READ) == read_;
  if (!same && context_ != EGL_NO_CONTEXT) eglMakeCurrent(display_, draw_, read_, context_);
  if (!same && context_ == EGL_NO_CONTEXT)
    eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ == EGL_NO_CONTEXT) return;
  // Bounded: a context that is lost tells so for ever.
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

}  // namespace apps
