#pragma once
/// An OpenGL 4.5 core context without a window. The renderer accepts any current context, whoever created it.

#include <memory>
#include <string>

namespace sim {

/// EGL handles of a context, for other libraries.
struct EglHandles {
  void* display = nullptr;
  void* config = nullptr;
  void* context = nullptr;
};

/// GLX handles of a context, for other libraries.
struct GlxHandles {
  void* display = nullptr;  ///< null: not a GLX context
  void* config = nullptr;
  unsigned long drawable = 0;
  void* context = nullptr;
  unsigned visual = 0;
};

/// A context without a window; destroyed with the object. The functions make_headless() and make_on_x() leave
/// it current on the calling thread.
class GlContext {
 public:
  /// Uses EGL. Order of attempts: EGL devices with hardware (a GPU without a display), Mesa's surfaceless
  /// platform, EGL's software devices. Errors: base::Error if there is no EGL or no driver with OpenGL 4.5,
  /// with the message of each attempt.
  static GlContext make_headless();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  /// Uses GLX on the X display that $DISPLAY names, for libraries that do not support EGL. base::Error if
  /// there is no such display, or no OpenGL 4.5 core context on it.
  static GlContext make_on_x();

  /// Another context that shares textures and buffers with this one; not current on any thread. base::Error
  /// if the driver refuses.
  GlContext make_shared() const;

  /// Makes the context current on the calling thread. If it is current on another thread, call release()
  /// there first.
  void make_current();
  /// Leaves the calling thread without a current context.
  void release();
  EglHandles egl() const;
  GlxHandles glx() const;

  struct State;

 private:
  explicit GlContext(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// GL_RENDERER and GL_VERSION of the current context, for records and logs.
std::string gl_description();
/// True if the current context is rendered on the CPU, by the name of the renderer (such as llvmpipe).
bool gl_is_software();
/// base::Error unless a context of OpenGL 4.5 or newer is current. Call it once for each new context.
void require_gl45();

}  // namespace sim
