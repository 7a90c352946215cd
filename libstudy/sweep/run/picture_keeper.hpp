#pragma once
/// Takes the pictures that a cell of a sweep stores.

#include <memory>

#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/sweep/kept_picture.hpp"
#include "stats/base/picture_size.hpp"

namespace study {

/// Draws and stores pictures of the water outside the timing.
class PictureKeeper {
 public:
  /// Uses the current context if there is one, which must outlive this object, or else its own.
  PictureKeeper(const sim::Scene& scene, const base::PictureSize& size, bool context_is_current);
  ~PictureKeeper();

  /// At the middle of the picture.
  double pixels_per_degree() const;
  /// `frame` is the run's. With `masks`, also stores the masks of the gaze's fovea (the tuned half angle) and
  /// of the most salient part outside it; this sorts the particles.
  KeptPicture keep(sim::Simulation& fluid, int frame, double frame_dt_s, bool masks);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace study
