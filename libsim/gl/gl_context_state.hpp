#pragma once
/// Interface of a GlContext's implementations: one for EGL, one for GLX.

#include <memory>

#include "libsim/gl/gl_context.hpp"

namespace sim {

struct GlContext::State {
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  virtual ~State() = default;
  virtual bool make_current() = 0;
  virtual void release() = 0;
  /// A context that shares objects with this one; null if the driver refuses.
  virtual std::unique_ptr<State> make_shared() const = 0;
  virtual EglHandles egl() const { return {}; }
  virtual GlxHandles glx() const { return {}; }
};

}  // namespace sim
