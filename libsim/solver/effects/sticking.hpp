#pragma once
/// Viscous fluid that sticks to obstacles.

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/effects/body_layer.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// Rows of bodies in the linear system of the implicit viscosity, whose unknowns are the velocities of the
/// particles (viscosity_weiler2018.cpp). A free body is an unknown of this system too, so that fluid and body
/// are coupled implicitly, even if the body is light. Every step of the conjugate gradients then conserves
/// the total momentum and angular momentum. Rows of other bodies take the same steps, but do not count in the
/// inner products: they record exactly the momentum that the fluid lost. Without rows, moves() is false for
/// every body.
struct BodyRows {
  BodyRow* rows;
  const Body* bodies;
  const FreeBody* free;  ///< dynamic state of each body; nullptr: no body is free
  int count;             ///< number of rows
  /// Unit of the fixed-point sums in the rows, m_* m/s with m_* the mass of a particle of level 0. It grows
  /// with the largest factor by which a body can brake a particle in a substep (`steps` in
  /// StickingBodies::each), because residuals and directions exceed the fluid's speeds by up to this factor,
  /// and fixed point has a limited range.
  float unit;
  float dt;

  SIM_FN bool moves(int b) const { return rows && free && free[b].mass > 0; }
  /// Velocity at x that the fluid's pressure gives body b within the substep; 0 unless it is free.
  SIM_FN Vec3 pressed(int b, Vec3 x) const {
    if (!moves(b)) return {0, 0, 0};
    const FreeBody& it = free[b];
    const Vec3 round = spin_of(it, bodies[b].turn, it.torque);
    return dt * ((1 / it.mass) * it.force + cross(round, x - bodies[b].centre));
  }
  /// The particles' sums for body b, as velocity and angular velocity if it is free, otherwise as momentum
  /// and moment. They belong to the residual or to A p, with A the system's matrix and p the search
  /// direction. Resets the sums.
  SIM_FN BodyTurn given(int b) const {
    BodyRow& row = rows[b];
    const Vec3 push = unit * row.push.value(), moment = unit * row.moment.value();
    row.push = row.moment = {};
    if (!moves(b)) return {push, moment};
    return {(1 / free[b].mass) * push, spin_of(free[b], bodies[b].turn, moment)};
  }
  /// Inner product of two rates of body b, weighted by its mass and its inertia; 0 unless it is free.
  SIM_FN float product(int b, BodyTurn a, BodyTurn other) const {
    if (!moves(b)) return 0;
    return free[b].mass * dot(a.along, other.along) +
           dot(a.round, momentum_of(free[b], bodies[b].turn, other.round));
  }
  /// Sets residual and direction of all rows from the particles' first sums; returns the rows' part of the
  /// squared residual.
  SIM_FN float begin() const {
    float out = 0;
    for (int b = 0; b < count; ++b) {
      rows[b].gained = {};
      rows[b].residual = rows[b].direction = given(b);
      out += product(b, rows[b].residual, rows[b].residual);
    }
    return out;
  }
  /// Computes A p of all rows from the direction p; returns the rows' part of p A p.
  SIM_FN float bend() const {
    float out = 0;
    for (int b = 0; b < count; ++b) {
      BodyRow& row = rows[b];
      row.bent = added(row.direction, -1, given(b));
      out += product(b, row.direction, row.bent);
    }
    return out;
  }
  /// Takes a step in all rows; returns their part of the new squared residual.
  SIM_FN float advance(float step) const {
    float out = 0;
    for (int b = 0; b < count; ++b) {
      BodyRow& row = rows[b];
      row.gained = added(row.gained, step, row.direction);
      row.residual = added(row.residual, -step, row.bent);
      out += product(b, row.residual, row.residual);
    }
    return out;
  }
  SIM_FN void turn(float kept) const {
    for (int b = 0; b < count; ++b) rows[b].direction = added(rows[b].residual, kept, rows[b].direction);
  }
  SIM_FN static BodyTurn added(BodyTurn a, float times, BodyTurn other) {
    return {a.along + times * other.along, a.round + times * other.round};
  }
};

/// Walls and obstacles also resist what moves towards or away from them, by this share of what they would
/// resist along themselves if the fluid sticks. Pressure alone would hold the fluid up only after gravity has
/// moved it by g dt^2 in each substep, however viscous it is (docs/decisions.md, Thick fluids).
constexpr float upright_share = 0.25f;

/// The shear stress rho_0 nu u / s, with the kinematic viscosity nu, acts on fluid within its spacing d of an
/// obstacle's surface; s is the distance to the surface and u the slip speed. This layer has one particle per
/// area d^2 at every level. The fluid then comes to rest at the surface itself, in a lattice at any s and in
/// disordered fluid. u is relative to the body's rigid motion extended to the particle: fluid that rotates
/// with a body is not braked. Along the surface u counts by the effect's stick, along the normal by
/// upright_share. In the implicit step the terms stay symmetric and positive
/// definite: each is the square of a difference.
struct StickingBodies {
  static constexpr bool there = true;
  Solids solids;
  BodyRows rows;
  float rate;            ///< nu dt, m2
  float stick;           ///< the effect's coefficient (0: fluid slips, 1: it sticks)
  float finest_support;  ///< support of the finest particles (mass m_*), m
  /// Minimum s as a share of d, equal to the minimum distance between particles and walls.
  static constexpr float nearest = 0.1f;

  /// Calls then(number, part of v that the body removes in dt) for each body near the particle. If First, v
  /// is a velocity, otherwise a direction of the conjugate gradients.
  template <bool First, class Then>
  SIM_FN void each(Vec4 at, Vec3 v, Then then) const {
    const float d = 0.5f * at.w;
    for_bodies_within(solids, xyz(at), d, [&](int b, const Body& body, const Body::Near& near) {
      const float steps =
          rate * face_share(body, xyz(at), near.distance) / (d * at_least(near.distance, nearest * d));
      const Vec3 slip = v - (First ? before_pressure(b, body, xyz(at)) : way_of(b, xyz(at)));
      then(b, steps * (stick * slip + (upright_share - stick) * dot(slip, near.normal) * near.normal));
    });
  }
  /// The body's velocity at x without what pressure gave it in this substep. The fluid has its gravity and
  /// not yet its pressure: compared with a body that has both, it would drag floating bodies down.
  SIM_FN Vec3 before_pressure(int b, const Body& body, Vec3 x) const {
    return body.velocity_at(x) - rows.pressed(b, x);
  }
  SIM_FN Vec3 way_of(int b, Vec3 x) const {
    if (!rows.moves(b)) return {0, 0, 0};
    const BodyTurn p = rows.rows[b].direction;
    return p.along + cross(p.round, x - solids.bodies[b].centre);
  }
  /// Sum of the parts of v that all bodies remove. Each part times the particle's mass is also added to its
  /// body's row.
  template <bool First>
  SIM_FN Vec3 taken(Vec4 at, Vec3 v) const {
    Vec3 out{0, 0, 0};
    each<First>(at, v, [&](int b, Vec3 part) {
      out += part;
      if (!rows.rows) return;
      const Vec3 push = (mass_units_of(at.w, finest_support) / rows.unit) * part;
      Momentum sum{}, moment{};
      sum.add(1, push);
      moment.add(1, cross(xyz(at) - solids.bodies[b].centre, push));
      rows.rows[b].push.add_at_once(sum);
      rows.rows[b].moment.add_at_once(moment);
    });
    return out;
  }
};

/// TakeRest, TakeStep and TakeNext finish an inner product that was summed over the particles: they add the
/// part of the free bodies, and update all rows.
template <class Bodies>
struct TakeRest {
  TakeTurn take;
  Bodies bodies;
  SIM_FN void operator()(float rest) const {
    if constexpr (Bodies::there) rest += bodies.rows.begin();
    take(rest);
  }
};
template <class Bodies>
struct TakeStep {
  TakeAlong take;
  Bodies bodies;
  SIM_FN void operator()(float bent) const {
    if constexpr (Bodies::there) bent += bodies.rows.bend();
    take(bent);
  }
};
template <class Bodies>
struct TakeNext {
  TakeTurn take;
  Bodies bodies;
  SIM_FN void operator()(float rest) const {
    if constexpr (Bodies::there) rest += bodies.rows.advance(take.step->along);
    take(rest);
    if constexpr (Bodies::there) bodies.rows.turn(take.step->turn);
  }
};

/// Subtracts the momentum that each row gained, times dt, from the body's recorded sums, which are pushes of
/// the body on the fluid.
struct RecordGained {
  BodyRows rows;
  BodyListener to;
  float dt;
  SIM_FN void operator()(int b) const {
    const BodyTurn gained = rows.rows[b].gained;
    const bool moves = rows.moves(b);
    const float mass = moves ? rows.free[b].mass : 1.0f;
    const Vec3 moment = moves ? momentum_of(rows.free[b], rows.bodies[b].turn, gained.round) : gained.round;
    to.sums[b].push.add(-dt * mass, gained.along);
    to.sums[b].moment.add(-dt, moment);
  }
};

}  // namespace sim::SIM_BACKEND
