/// Friction: walls and obstacles slow water that slides along them.

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/effects/body_layer.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A wall brakes water that slides along it at the speed u with the stress rho_0 c u (Navier's law of slip;
/// with the viscosity nu, nu / c is its slip length), so that a sheet of depth H slides a distance u H / c.
/// The stress acts on the layer of particles within their spacing d of the wall, in which u decreases at the
/// rate c / d. This layer has one particle per area d^2, in a lattice and in disordered water, at every
/// level. A substep removes at most all of u, and so is stable for any step; a large c stops the layer.
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

/// Obstacles that brake water. The reaction on each obstacle is recorded.
struct BrakingBodies {
  Solids solids;
  const FreeBody* free;  ///< dynamic state of each body; nullptr: no body is free
  BodyListener to;

  /// Maximum share of the slip that a substep removes at body b. A free body that is lighter than the layer
  /// of water it brakes would otherwise oscillate. At the limit, body and layer get the same speed. The limit
  /// assumes the largest possible layer: a shell around a ball that contains the body.
  SIM_FN float most_steps(int b, float d) const {
    if (!free || free[b].mass == 0) return 1;
    const float out = length(solids.bodies[b].half) + solids.bodies[b].radius + d;
    const float layer = 4 * pi * out * out * d / mass_of(to.finest_support, 1);
    const Vec3 own = free[b].inertia;
    const float least = at_most(at_most(own.x, own.y), own.z);
    return 1 / (1 + layer * at_least(1 / free[b].mass, out * out / least));
  }
};

SIM_FN Vec3 slowed_by(const BrakingBodies& bodies, Vec4 at, Vec3 v, float way) {
  const float d = 0.5f * at.w;
  for_bodies_within(bodies.solids, xyz(at), d, [&](int b, const Body& body, const Body::Near& near) {
    const float steps = way / d * face_share(body, xyz(at), near.distance);
    const Vec3 before = v;
    v = slowed(v, body.velocity_at(xyz(at)), near.normal, at_most(steps, bodies.most_steps(b, d)));
    if (bodies.to.sums)
      bodies.to.add(b, at, xyz(at),
                    (bodies.solids.dt * mass_units_of(at.w, bodies.to.finest_support)) * (v - before));
  });
  return slowed_by(bodies.solids.walls, at, v, way);
}

/// Applies friction to all particles, solved or not, unless they are too coarse for the effect. (With the
/// preset `tuned`, all particles near walls and obstacles are solved in every frame.)
template <class Boundary>
struct Slide {
  const Vec4* position;
  Vec4* velocity;
  Boundary boundary;
  float way;     ///< c dt, m, with c the effect's coefficient, m/s
  float widest;  ///< largest support of particles on which the effect acts, m
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
    velocity[i] = with_w(slowed_by(boundary, at, xyz(velocity[i]), way), 0);
  }
};

using FrictionColumns = ColumnView<columns(Column::Position, Column::Velocity), columns(Column::Velocity)>;

template <class Boundary>
void launch(FluidState& state, FrictionColumns p, Boundary boundary) {
  const auto& k = state.parameters;
  for_each("friction", p.size(),
           Slide<Boundary>{.position = p.position(),
                           .velocity = p.velocity(),
                           .boundary = boundary,
                           .way = k.dt * k.effects[EffectKind::Friction],
                           .widest = state.widest_support(EffectOption::FrictionCoarsest)});
}

void run_friction(FluidState& state, FrictionColumns p) {
  if (!state.obstacles.exists()) return launch(state, p, state.walls);
  const auto& free = state.obstacles.free;
  launch(state, p,
         BrakingBodies{state.solids(), free.size() > 0 ? free.data() : nullptr, state.effects_listener()});
}

}  // namespace

std::vector<Stage> friction_stages() {
  return {stage_of<run_friction>({.name = "friction", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
