#pragma once
/// The present state of a simulation, drawn, and what its viewer tells it before the next frame.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/saliency/looks.hpp"
#include "libsim/simulation.hpp"

namespace apps {

/// Needs a current context at every call and when it is destroyed.
class FluidPicture {
 public:
  explicit FluidPicture(const sim::Scene& scene, const sim::RenderOptions& options = {})
      : renderer_(scene, options) {}

  /// Forgets what was drawn before another run. `seen`, if any, is what its viewer saw last; it must live
  /// until the first draw.
  void begin(const sim::GBuffer* seen);
  /// Takes the particles, on the device where the back end shares memory with GL, and draws them.
  void draw(sim::Simulation& fluid, std::span<const sim::View> views, unsigned framebuffer) {
    take(fluid);
    show(views, framebuffer);
  }
  void draw(sim::Simulation& fluid, const sim::View& view, unsigned framebuffer) {
    draw(fluid, std::span(&view, 1), framebuffer);
  }
  /// draw() in two steps, for who times them apart.
  void take(sim::Simulation& fluid);
  void show(std::span<const sim::View> views, unsigned framebuffer);
  /// Tells the simulation where one looks in the coming frame and, once something was drawn, what was seen in
  /// the last one. The picture stays on the device where the back end shares memory with GL, otherwise it
  /// takes a way through the host; it is the last one drawn either way.
  /// visual_scale: sim::EyeLook's.
  void look(sim::Simulation& fluid, const sim::View& view, const sim::Gaze& gaze, double visual_scale = 1);
  sim::FluidRenderer& renderer() { return renderer_; }
  const sim::FluidRenderer& renderer() const { return renderer_; }
  /// Whether the last particles went a way through the host.
  bool uploaded() const { return uploaded_; }

 private:
  void take_foam(sim::Simulation& fluid);

  sim::FluidRenderer renderer_;
  sim::ParticleBuffer buffer_, foam_;
  sim::GBuffer seen_;
  const sim::GBuffer* before_ = nullptr;
  int taken_frame_ = 0;             ///< of the simulation
  std::optional<int> drawn_frame_;  ///< the same, once it was drawn
  std::vector<sim::RenderParticle> particles_;
  bool uploaded_ = false;
};

/// "device", "host" or "none".
std::string picture_way_name(sim::PictureWay way);
/// "picture of frame 41 by way of device", or "no picture".
std::string in_words(const sim::SeenReport& seen);

/// A gaze from a camera's eye to a point.
sim::Gaze gaze_at(const sim::Camera& camera, const sim::Vec3d& point_m);
/// A gaze from a view's eye through a point of its picture, px from the lower left corner.
sim::Gaze gaze_through(const sim::View& view, double x_px, double y_px);

}  // namespace apps
