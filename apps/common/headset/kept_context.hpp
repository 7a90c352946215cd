#pragma once
/// The GL context of the calling thread, as it was before a call into the runtime.

#include "apps/common/headset/openxr.hpp"

namespace apps {

/// Runtimes make contexts of their own current and leave GL errors behind. When this object goes, the context
/// that was current when it came is current again and its errors are forgotten.
class KeptContext {
 public:
  /// on_x: a context of GLX, else of EGL.
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

}  // namespace apps
