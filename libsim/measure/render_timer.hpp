#pragma once
/// Renders the fluid of a benchmark. Times the rendering separately from the solver, and each of the
/// renderer's passes over many pictures.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// Milliseconds of each pass per picture.
class PassTable {
 public:
  void add(std::span<const sim::PassTime> picture);
  void clear() { passes_.clear(); }
  bool empty() const { return passes_.empty(); }
  /// A JSON object with the median of each pass.
  base::Json figures() const;

 private:
  struct Pass {
    std::string name;
    std::vector<double> ms;
  };
  std::vector<Pass> passes_;
};

/// Prints PassTable::figures(), the longest pass first, and their sum.
void print_passes(const base::Json& figures);

/// Views of the scene's camera for `count` eyes, side by side, each of this size.
std::vector<sim::View> make_views(const sim::Scene& scene, const base::PictureSize& size, int count);

/// Draws an off-screen picture of a scene and times it. The context stays current on this thread.
class RenderTimer {
 public:
  /// `views`: 1, or 2 side by side, 64 mm apart. base::Error for a size that the driver refuses.
  RenderTimer(sim::GlContext context, const sim::Scene& scene, const base::PictureSize& size, int views,
              sim::Surface surface = sim::Surface::Ellipsoids);
  ~RenderTimer();

  /// Milliseconds of one picture; each part ends when the device is idle.
  struct Times {
    double transfer = 0;  ///< from the solver's particles to the GL buffer
    double render = 0;    ///< from the draw call to the finished picture
  };
  /// Draws untimed pictures first, because the driver compiles at the first draw.
  void warm_up(sim::Simulation& fluid);
  /// Draws and times one picture of the fluid. Call it when the solver is idle.
  Times draw(sim::Simulation& fluid);
  /// Call it before a frame, as a live session does: passes the first view, a gaze at its middle and the last
  /// picture to the fluid.
  void look(sim::Simulation& fluid);

  /// Figures of the pictures since warm_up() as a JSON object; null without such a picture. Median, 95th and
  /// 99th percentile of render_ms and transfer_ms; the median time of each pass in ms; how particles reach
  /// OpenGL; width and height of a picture and the number of views; the OpenGL driver; and for the last
  /// picture the number of fluid pixels without a front particle and of particles outside the tank.
  base::Json figures() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Prints RenderTimer::figures() as lines of a table.
void print_render_figures(const base::Json& figures);

}  // namespace measure
