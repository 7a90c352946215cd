/// Friction: walls and obstacles slow what slides along them.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A wall brakes what slides along it at the speed u by the stress rho_0 c u (Navier's law of slip; nu / c is
/// its slip length), so that a sheet of depth H slides u H / c far. The stress acts on the layer that lies
/// within a particle's own spacing d of the wall: there u falls at the rate c / d. Any lattice and any water
/// without order have one particle a face d^2 there, whatever their level. A substep takes at most all of u,
/// so that none is too long: a large c holds the layer.
SIM_FN Vec3 slowed(Vec3 v, Vec3 wall_velocity, Vec3 normal, float steps) {
  const Vec3 slip = v - wall_velocity;
  return v - at_most(steps, 1.0f) * (slip - dot(slip, normal) * normal);
}

SIM_FN Vec3 slowed_by(const Walls& walls, Vec4 at, Vec3 v, float way) {
  const float d = 0.5f * at.w;
  for (int k = 0; k < walls.count; ++k) {
    if (walls.distance(k, xyz(at)) >= d || walls.absent(k, xyz(at))) continue;
    v = slowed(v, {0, 0, 0}, walls.planes[k].normal, way / d);
  }
  return v;
}

/// Face of a body over that of its layer at x: round a sphere a layer is larger than the face below.
SIM_FN float face_share(const Body& body, Vec3 x, float distance) {
  if (body.radius == 0) return 1;
  const float share = body.radius / (body.radius + at_least(distance, 0.0f));
  const bool on_side = fabsf(body.to_body(x).y) < body.half.y;
  return on_side ? share : share * share;
}

SIM_FN Vec3 slowed_by(const Solids& solids, Vec4 at, Vec3 v, float way) {
  const float d = 0.5f * at.w;
  for (int b = 0; b < solids.count; ++b) {
    const Body& body = solids.bodies[b];
    const Body::Near near = solids.near(b, xyz(at));
    if (near.distance >= d) continue;
    v = slowed(v, body.velocity_at(xyz(at)), near.normal, way / d * face_share(body, xyz(at), near.distance));
  }
  return slowed_by(solids.walls, at, v, way);
}

/// Everyone, also those that temporal acceleration does not solve: the tuned readings let nobody rest near a
/// wall.
template <class Boundary>
struct Slide {
  const Vec4* position;
  Vec4* velocity;
  Boundary boundary;
  float way;     ///< c dt, m
  float widest;  ///< support that takes part, m
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
    velocity[i] = with_w(slowed_by(boundary, at, xyz(velocity[i]), way), 0);
  }
};

using Columns = ColumnView<columns(Column::Position, Column::Velocity), columns(Column::Velocity)>;

template <class Boundary>
void launch(FluidState& state, Columns p, Boundary boundary) {
  const auto& k = state.parameters;
  for_each("friction", p.size(),
           Slide<Boundary>{.position = p.position(),
                           .velocity = p.velocity(),
                           .boundary = boundary,
                           .way = k.dt * k.effects[EffectKind::Friction],
                           .widest = state.widest_support(EffectOption::FrictionCoarsest)});
}

void run(FluidState& state, Columns p) {
  state.obstacles.there() ? launch(state, p, state.solids()) : launch(state, p, state.walls);
}

}  // namespace

std::vector<Stage> friction_stages() {
  return {stage_of<run>({.name = "friction", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
