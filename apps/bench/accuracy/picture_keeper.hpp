#pragma once
/// Takes the pictures that a cell of a sweep keeps.

#include <memory>

#include "apps/common/picture_size.hpp"
#include "apps/common/sweep/kept_picture.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"

namespace apps {

/// Draws the water apart from what is timed and keeps the picture.
class PictureKeeper {
 public:
  /// In the current context if there is one, which must outlive this, else in one of its own.
  PictureKeeper(const sim::Scene& scene, const PictureSize& size, bool context_is_current);
  ~PictureKeeper();

  /// At the middle of the picture.
  double pixels_per_degree() const;
  /// `frame` is the run's. With `masks` those of the gaze's fovea (the tuned half angle) and of what is most
  /// salient beyond it; this sorts the particles.
  KeptPicture keep(sim::Simulation& fluid, int frame, double frame_dt_s, bool masks);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace apps
