#pragma once
/// The water next to obstacles, for effects that act on this layer.

#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Replaces the bodies if an effect has no obstacles to act on.
struct NoBodies {
  static constexpr bool there = false;
};

/// True if x is farther from the body's bounding sphere than `reach`. This test is cheaper than the distance
/// from the body.
SIM_FN bool far_from(const Body& body, Vec3 x, float reach) {
  const Vec3 away = x - body.centre;
  const float most = length(body.half) + body.radius + reach;
  return dot(away, away) > most * most;
}

/// Calls then(number, body, near) for each body whose surface is within `reach` of x.
template <class Then>
SIM_FN void for_bodies_within(const Solids& solids, Vec3 x, float reach, Then then) {
  for (int b = 0; b < solids.count; ++b) {
    const Body& body = solids.bodies[b];
    if (far_from(body, x, reach)) continue;
    const Body::Near near = solids.near(b, x);
    if (near.distance < reach) then(b, body, near);
  }
}

/// Area of a small patch of the body's surface below x, divided by the area of the patch shifted outwards by
/// `distance` along its normals. The ratio is below 1 at round surfaces, and 1 at flat ones.
SIM_FN float face_share(const Body& body, Vec3 x, float distance) {
  if (body.radius == 0) return 1;
  const float share = body.radius / (body.radius + at_least(distance, 0.0f));
  const bool on_side = fabsf(body.to_body(x).y) < body.half.y;
  return on_side ? share : share * share;
}

}  // namespace sim::SIM_BACKEND
