#pragma once
/// Draws the current state of a simulation, and passes the viewer's gaze and last picture to it before the
/// next frame.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/saliency/looks.hpp"
#include "libsim/simulation.hpp"

namespace apps {

/// Needs a current GL context at every call and when it is destroyed.
class FluidPicture {
 public:
  explicit FluidPicture(const sim::Scene& scene, const sim::RenderOptions& options = {})
      : renderer_(scene, options) {}

  /// Forgets the last picture before a new run. `seen`, if not null, is the picture that the viewer saw last;
  /// it must live until the first draw.
  void begin(const sim::GBuffer* seen);
  /// Gets the particles, on the device if the back end shares memory with GL, and draws them.
  void draw(sim::Simulation& fluid, std::span<const sim::View> views, unsigned framebuffer) {
    take(fluid);
    show(views, framebuffer);
  }
  void draw(sim::Simulation& fluid, const sim::View& view, unsigned framebuffer) {
    draw(fluid, std::span(&view, 1), framebuffer);
  }
  /// The two steps of draw(), for callers that time them separately.
  void take(sim::Simulation& fluid);
  void show(std::span<const sim::View> views, unsigned framebuffer);
  /// Passes the gaze of the coming frame to the simulation and, once something was drawn, the last picture.
  /// The picture stays on the device if the back end shares memory with GL; otherwise it is copied through
  /// the host.
  /// visual_scale: as sim::EyeLook::visual_scale.
  void look(sim::Simulation& fluid, const sim::View& view, const sim::Gaze& gaze, double visual_scale = 1);
  sim::FluidRenderer& renderer() { return renderer_; }
  const sim::FluidRenderer& renderer() const { return renderer_; }
  /// True if the last particles were copied through the host.
  bool uploaded() const { return uploaded_; }

 private:
  void take_foam(sim::Simulation& fluid);

  sim::FluidRenderer renderer_;
  sim::ParticleBuffer buffer_, foam_;
  sim::GBuffer seen_;
  const sim::GBuffer* before_ = nullptr;
  int taken_frame_ = 0;             ///< frame of the simulation that was taken last
  std::optional<int> drawn_frame_;  ///< frame that was drawn last; none before the first draw
  std::vector<sim::RenderParticle> particles_;
  bool uploaded_ = false;
};

/// "device", "host" or "none".
std::string picture_way_name(sim::PictureWay way);
/// "picture of frame 41 by way of device", or "no picture".
std::string in_words(const sim::SeenReport& seen);

/// The gaze from a camera's eye to a point.
sim::Gaze gaze_at(const sim::Camera& camera, const sim::Vec3d& point_m);
/// The gaze from a view's eye through a point of its picture, px from the lower left corner.
sim::Gaze gaze_through(const sim::View& view, double x_px, double y_px);

}  // namespace apps
