#pragma once
/// A camera that watches a run frame by frame and supplies pictures to the image metrics.

#include <cstdint>
#include <vector>

#include "libsim/gl/offscreen.hpp"
#include "libsim/gl/png.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/render/fluid_picture.hpp"

namespace measure {

/// Needs a current context at every call and when it is destroyed.
class Onlooker {
 public:
  Onlooker(const sim::Scene& scene, const base::PictureSize& size);

  const sim::View& view() const { return view_; }
  const sim::Camera& camera() const { return camera_; }
  /// Replaces the last picture by `seen` (nullptr: none); call it before another run (FluidPicture::begin).
  void begin(const sim::GBuffer* seen) { picture_.begin(seen); }
  /// Passes the gaze and the last picture to a method that uses them.
  void look(sim::Simulation& fluid, const sim::Vec3d& gaze_m) {
    picture_.look(fluid, view_, sim::gaze_at(camera_, gaze_m));
  }
  /// Calls look(), advances by a frame, and draws if `wanted`, if the run computes saliency from pictures, or
  /// if pictures depend on those before.
  /// Passes the measured duration to Simulation::frame_time.
  void step(sim::Simulation& fluid, const sim::Vec3d& gaze_m, bool wanted);
  void draw(sim::Simulation& fluid) { picture_.draw(fluid, view_, target_.framebuffer()); }

  // Data of the last picture drawn.
  sim::Image image() const { return target_.read(); }
  sim::Picture picture() const { return sim::without_alpha(image()); }
  sim::GBuffer gbuffer() const { return picture_.renderer().read_gbuffer(); }
  /// Mask of the fluid's pixels (1; others 0) in the last picture; row 0 is the top.
  std::vector<std::uint8_t> fluid_mask() const;
  /// The last picture with the water painted by level. `finest_spacing_m`: 2 r_*, the diameter of particles
  /// of level 0.
  sim::Image painted_by_level(sim::Simulation& fluid, double finest_spacing_m);

 private:
  sim::Camera camera_;
  sim::View view_;
  sim::Offscreen target_;
  sim::FluidPicture picture_;
};

}  // namespace measure
