#pragma once
/// Runs of a fluid that is drawn by several surfaces at once: change of the picture from frame to frame, and
/// milliseconds of the renderer.

#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// Mean absolute change of the picture from one frame to the next, over pixels and colours, of 255.
struct Popping {
  double turning = 0;  ///< in frames in which particles split or merged
  double other = 0;    ///< in the other frames
  int turns = 0, others = 0;
  double ratio() const { return turning / other; }
};

/// Steps the fluid and draws each frame once by each of `surfaces`. The method gets the pictures of the last
/// one, and the scene's gaze. The first `warm_up` frames do not count: in them a method with levels
/// finds its levels. One result per surface, all of the same states. Needs a current context. base::Error if
/// particles split or merged in every counted frame, or in none.
std::vector<Popping> measure_popping(const sim::Scene& scene, const sim::SimulationOptions& fluid,
                                     int warm_up, int frames, const base::PictureSize& size,
                                     const std::vector<sim::Surface>& surfaces);

/// Medians over the frames, ms.
struct DrawTimes {
  double take = 0;  ///< the particles' way to OpenGL; with ellipsoids, also their computation
  double draw = 0;  ///< the picture
};

/// Steps the fluid and draws each frame by each surface in turn, for `views` eyes side by side. One result
/// per surface. Needs a current context.
std::vector<DrawTimes> measure_draw_times(const sim::Scene& scene, const sim::SimulationOptions& fluid,
                                          int frames, const base::PictureSize& size, int views,
                                          const std::vector<sim::Surface>& surfaces);

}  // namespace measure
