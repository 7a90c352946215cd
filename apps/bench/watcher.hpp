#pragma once
/// Looks at a run as a live session does: at the middle of each picture, which the method sees.

#include "apps/common/fluid_picture.hpp"
#include "apps/common/picture_size.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

/// Needs a current context at every call and when it is destroyed.
class Watcher {
 public:
  Watcher(const sim::Scene& scene, const PictureSize& size)
      : view_(sim::make_view(scene.view, size.width, size.height)),
        target_(size.width, size.height),
        picture_(scene) {}

  /// Before a frame.
  void look(sim::Simulation& fluid) {
    const auto& shown = view_.viewport;
    picture_.look(fluid, view_, gaze_through(view_, 0.5 * shown.width, 0.5 * shown.height));
  }
  /// After it, and before the first.
  void draw(sim::Simulation& fluid) { picture_.draw(fluid, view_, target_.framebuffer()); }

 private:
  sim::View view_;
  sim::Offscreen target_;
  FluidPicture picture_;
};

}  // namespace apps
