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

namespace sim {

/// Needs a current GL context at every call and when it is destroyed.
class FluidPicture {
 public:
  explicit FluidPicture(const Scene& scene, const RenderOptions& options = {})
      : renderer_(scene, options), surface_(options.surface) {}

  /// Forgets the last picture before a new run. `seen`, if not null, is the picture that the viewer saw last.
  /// `seen` must live until the first draw; if the method uses no pictures, until the next begin().
  void begin(const GBuffer* seen);
  /// Gets the particles, on the device if the back end shares memory with GL, and draws them.
  void draw(Simulation& fluid, std::span<const View> views, unsigned framebuffer) {
    take(fluid);
    show(views, framebuffer);
  }
  void draw(Simulation& fluid, const View& view, unsigned framebuffer) {
    draw(fluid, std::span(&view, 1), framebuffer);
  }
  /// The two steps of draw(), for callers that time them separately.
  void take(Simulation& fluid);
  void show(std::span<const View> views, unsigned framebuffer);
  /// Passes the gaze of the coming frame to the simulation and, if the method uses pictures, the last
  /// picture; before the first draw, the picture given to begin(). The picture stays on the device if the
  /// back end shares memory with GL; otherwise it is copied through the host. visual_scale: tan of half the
  /// angle of the picture at the viewer's eye / tan of half the camera's angle (sim::EyeLook::visual_scale).
  void look(Simulation& fluid, const View& view, const Gaze& gaze, double visual_scale = 1);
  FluidRenderer& renderer() { return renderer_; }
  const FluidRenderer& renderer() const { return renderer_; }
  /// True if the last take() copied the particles through the host.
  bool uploaded() const { return uploaded_; }

 private:
  // Both return true if the device wrote the buffer, or else read particles and shapes to the host.
  bool take_particles(Simulation& fluid);
  bool take_surface(Simulation& fluid);
  void take_foam(Simulation& fluid);

  FluidRenderer renderer_;
  Surface surface_;
  ParticleBuffer buffer_, foam_;
  GBuffer seen_;
  const GBuffer* before_ = nullptr;
  int taken_frame_ = 0;             ///< simulation frame of the last take()
  std::optional<int> drawn_frame_;  ///< simulation frame of the last picture; none before the first draw
  std::vector<RenderParticle> particles_;
  std::vector<RenderShape> shapes_;
  bool uploaded_ = false;
};

/// Name, for records, of the way in which a picture was passed to saliency: "device", "host" or "none".
std::string picture_way_name(PictureWay way);
/// "picture of frame 41 by way of device", or "no picture".
std::string in_words(const SeenReport& seen);

/// The gaze from a camera's eye to a point.
Gaze gaze_at(const Camera& camera, const Vec3d& point_m);
/// The gaze from a view's eye through a point of its picture, px from the lower left corner.
Gaze gaze_through(const View& view, double x_px, double y_px);

}  // namespace sim
