#pragma once
/// The present state of a simulation, drawn.

#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/simulation.hpp"

namespace apps {

/// Needs a current context at every call and when it is destroyed.
class FluidPicture {
 public:
  explicit FluidPicture(const sim::Scene& scene, const sim::RenderOptions& options = {})
      : renderer_(scene, options) {}

  /// Takes the particles, on the device where the back end shares memory with GL, and draws them.
  void draw(sim::Simulation& fluid, const sim::View& view, unsigned framebuffer);
  const sim::FluidRenderer& renderer() const { return renderer_; }
  /// Whether the last particles went a way through the host.
  bool uploaded() const { return uploaded_; }

 private:
  sim::FluidRenderer renderer_;
  sim::ParticleBuffer buffer_;
  std::vector<sim::RenderParticle> particles_;
  bool uploaded_ = false;
};

}  // namespace apps
