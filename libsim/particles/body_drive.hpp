#pragma once
/// Forces on a free body other than contacts.

#include "libsim/particles/free_body.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Applies a substep's gravity, and the water's force of the previous substep.
struct BodyDrive {
  Guards* guards;
  float gravity, dt, most_speed;
  bool first;  ///< first substep of the frame

  SIM_FN void operator()(FreeBody& it) const {
    if (first) it.by_walls = {0, 0, 0};
    if (first) it.counted = it.counted_of_effects = {};
    it.momentum += dt * it.force;
    it.momentum.y -= it.mass * gravity * dt;
    it.spin += dt * it.torque;
    limit(it);
  }

 private:
  SIM_FN void limit(FreeBody& it) const {
    const float speed = length(it.momentum) / it.mass;
    if (speed <= most_speed) return;
    atomic_add(&guards->speed_limited, std::uint64_t{1});
    it.momentum = (most_speed / speed) * it.momentum;
  }
};

}  // namespace sim::SIM_BACKEND
