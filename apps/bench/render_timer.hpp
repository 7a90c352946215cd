#pragma once
/// Renders the fluid of a bench beside its solver, and keeps both clocks apart.

#include <memory>
#include <string>

#include "apps/common/picture_size.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// An off-screen picture of a scene, drawn and timed. The context stays current on this thread.
class RenderTimer {
 public:
  /// `views`: 1, or 2 side by side, 64 mm apart. Errors (base::Error): a size that the driver refuses.
  RenderTimer(sim::GlContext context, const sim::Scene& scene, const PictureSize& size, int views);
  ~RenderTimer();

  /// Milliseconds of one picture; each part ends with the device idle.
  struct Times {
    double transfer = 0;  ///< particles from the solver to the GL buffer
    double render = 0;    ///< draw call to the finished picture
  };
  /// Untimed pictures first: the driver compiles at the first draw.
  void warm_up(sim::Simulation& fluid);
  /// Call with the solver idle.
  Times draw(sim::Simulation& fluid);
  /// Before a frame, as a live session does: the eye is at the first view, looks at its middle and has seen
  /// the picture that was drawn last.
  void look(sim::Simulation& fluid);

  /// Keys render_ms_median, _p95, _p99, the same of transfer_ms, passes, ... of all pictures since warm_up;
  /// null before the first.
  base::Json figures() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The lines of the table for RenderTimer::figures().
void print_render_figures(const base::Json& figures);

}  // namespace apps
