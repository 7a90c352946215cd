#pragma once
/// One camera that looks at a run frame by frame and gives its picture to the image metrics.

#include <cstdint>
#include <vector>

#include "apps/bench/render_timer.hpp"
#include "apps/common/fluid_picture.hpp"
#include "apps/common/rgb_picture.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

/// Needs a current context at every call and when it is destroyed.
class Onlooker {
 public:
  Onlooker(const sim::Scene& scene, const PictureSize& size);

  const sim::View& view() const { return view_; }
  const sim::Camera& camera() const { return camera_; }
  /// Before another run; see FluidPicture::begin.
  void begin(const sim::GBuffer* seen) { picture_.begin(seen); }
  /// Tells a method that looks where the gaze is and, where it looks at pictures, what was drawn last.
  void look(sim::Simulation& fluid, sim::MethodKind method, const sim::Vec3d& gaze_m);
  /// Looks, if the method does, advances by a frame and, when asked to or when the method looks at pictures,
  /// draws.
  void step(sim::Simulation& fluid, sim::MethodKind method, const sim::Vec3d& gaze_m, bool draw);
  void draw(sim::Simulation& fluid) { picture_.draw(fluid, view_, target_.framebuffer()); }

  // Of the last picture drawn.
  sim::Image image() const { return target_.read(); }
  Picture picture() const { return without_alpha(image()); }
  sim::GBuffer gbuffer() const { return picture_.renderer().read_gbuffer(); }
  /// Pixels that show fluid: 1, else 0; row 0 is the top.
  std::vector<std::uint8_t> fluid_mask() const;
  /// The same picture with the water painted by level. `finest_spacing_m` is 2 r_*.
  sim::Image painted_by_level(sim::Simulation& fluid, double finest_spacing_m);

 private:
  sim::Camera camera_;
  sim::View view_;
  sim::Offscreen target_;
  FluidPicture picture_;
};

}  // namespace apps
