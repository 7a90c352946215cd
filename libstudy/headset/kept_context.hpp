#pragma once
/// Restores the calling thread's GL context after a call into the runtime.

#include "libstudy/headset/openxr.hpp"

namespace study {

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

}  // namespace study
