#pragma once
/// An OpenGL 4.5 core context without a window. The renderer needs a current context and does not care who
/// made it.

#include <memory>
#include <string>

namespace sim {

/// EGL's own names of a context, for those who hand it on.
struct EglHandles {
  void* display = nullptr;
  void* config = nullptr;
  void* context = nullptr;
};

/// The same of GLX.
struct GlxHandles {
  void* display = nullptr;  ///< none: it is no context of GLX
  void* config = nullptr;
  unsigned long drawable = 0;
  void* context = nullptr;
  unsigned visual = 0;
};

/// A context without a window, current on the thread that made it; destroyed with the object.
class GlContext {
 public:
  /// By EGL. Order of trial: EGL devices with hardware (a GPU without a display), Mesa's surfaceless
  /// platform, EGL's software devices. Errors: base::Error when there is no EGL or no driver that gives
  /// OpenGL 4.5, with what each trial said.
  static GlContext make_headless();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  /// By GLX on the X display of $DISPLAY, for those who know no EGL. base::Error when there is none.
  static GlContext make_on_x();

  /// Another context that shares textures and buffers with this one; current nowhere. base::Error when the
  /// driver gives none.
  GlContext make_shared() const;

  /// Makes it current on the calling thread (release it on the other one first).
  void make_current();
  /// Leaves the calling thread without a context.
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
/// True when the current context is drawn by the processor (llvmpipe, softpipe, SWR).
bool gl_is_software();
/// base::Error unless a context of OpenGL 4.5 or newer is current; call once after a window made one.
void require_gl45();

}  // namespace sim
