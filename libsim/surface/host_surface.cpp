#include "libsim/surface/host_surface.hpp"

#include <algorithm>

#include "libsim/surface/ellipsoids.hpp"

namespace sim {

struct HostSurface::State {
  SIM_BACKEND::Domain tank;
  bool lid;
  SIM_BACKEND::Ellipsoids ellipsoids;
  SIM_BACKEND::Array<SIM_BACKEND::Vec4> position;
};

HostSurface::HostSurface(const Scene& scene) : state_(std::make_unique<State>()) {
  const auto& size = scene.tank_size_m;
  state_->tank = {{0, 0, 0},
                  {static_cast<float>(size[0]), static_cast<float>(size[1]), static_cast<float>(size[2])}};
  state_->lid = scene.lid;
}

HostSurface::~HostSurface() = default;

void HostSurface::shape(std::vector<RenderParticle>& particles, std::vector<RenderShape>& shapes) {
  State& s = *state_;
  std::vector<SIM_BACKEND::Vec4> position;
  position.reserve(particles.size());
  float finest = 0, coarsest = 0;
  for (const RenderParticle& p : particles) {
    const float support = 4 * p.radius_m;
    position.push_back({p.x_m, p.y_m, p.z_m, support});
    if (!(support > 0)) continue;
    finest = finest > 0 ? std::min(finest, support) : support;
    coarsest = std::max(coarsest, support);
  }
  if (!(finest > 0)) {
    shapes.assign(particles.size(), {});
    return;
  }
  s.position.from_host(position);
  s.ellipsoids.read({.n = static_cast<int>(position.size()),
                     .position = s.position.data(),
                     .velocity = nullptr,
                     .id = nullptr,
                     .most_ids = 0,
                     .frame = 0,
                     .follow = 1,
                     .frame_s = 0,
                     .support = std::min(1.26F * finest, coarsest),
                     .tank = s.tank,
                     .lid = s.lid},
                    particles, shapes);
}

}  // namespace sim
