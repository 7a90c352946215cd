#pragma once
/// Ellipsoids of particles on the host, such as those of a bake, computed on the CPU.

#include <memory>
#include <vector>

#include "libsim/particles/particle_state.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

class HostSurface {
 public:
  /// `scene`: its tank's walls mirror the water, so that water has no surface at a wall.
  explicit HostSurface(const Scene& scene);
  ~HostSurface();

  /// Moves the particles to their smoothed places, and writes one shape per particle. Their velocities are
  /// not known, so that drops are round.
  void shape(std::vector<RenderParticle>& particles, std::vector<RenderShape>& shapes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sim
