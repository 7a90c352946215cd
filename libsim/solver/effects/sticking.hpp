#pragma once
/// Obstacles that hold viscous fluid.

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/effects/body_layer.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// Free bodies are rows of the same system as the particles: what holds the fluid is held by it, however
/// light. So every step of the conjugate gradients keeps the momentum and the spin of both together. Rows of
/// other bodies follow the same steps without a part in them: what they gain is what the fluid lost, however
/// few the steps. Without rows no body is free, and nobody asks.
struct BodyRows {
  BodyRow* rows;
  const Body* bodies;
  const FreeBody* free;  ///< nullptr: none is
  int count;             ///< of the rows
  /// Of their sums, m_* m/s: residuals and directions are as many times faster than the fluid as the stiffest
  /// particle's term is larger than 1, and fixed point holds only so much.
  float unit;

  SIM_FN bool moves(int b) const { return rows && free && free[b].mass > 0; }
  /// Of the residual and of A p what particles give; forgets what they gave.
  SIM_FN BodyTurn given(int b) const {
    BodyRow& row = rows[b];
    const Vec3 push = unit * row.push.value(), moment = unit * row.moment.value();
    row.push = row.moment = {};
    if (!moves(b)) return {push, moment};
    return {(1 / free[b].mass) * push, spin_of(free[b], bodies[b].turn, moment)};
  }
  /// m a a'.
  SIM_FN float product(int b, BodyTurn a, BodyTurn other) const {
    if (!moves(b)) return 0;
    return free[b].mass * dot(a.along, other.along) +
           dot(a.round, momentum_of(free[b], bodies[b].turn, other.round));
  }
  /// Residual and direction from what particles give at first; its square.
  SIM_FN float begin() const {
    float out = 0;
    for (int b = 0; b < count; ++b) {
      rows[b].gained = {};
      rows[b].residual = rows[b].direction = given(b);
      out += product(b, rows[b].residual, rows[b].residual);
    }
    return out;
  }
  /// p A p.
  SIM_FN float bend() const {
    float out = 0;
    for (int b = 0; b < count; ++b) {
      BodyRow& row = rows[b];
      row.bent = added(row.direction, -1, given(b));
      out += product(b, row.direction, row.bent);
    }
    return out;
  }
  /// The square of the new residual.
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

/// The fluid that lies within its own spacing d of a surface, one particle a face d^2 whatever its level,
/// feels the stress of the shear between: rho_0 nu u / s, at the distance s, where it slips by u. So a
/// lattice at any s, and fluid without order, come to rest at the surface itself. u counts along the surface,
/// and against the body's motion as if that went on to the particle: what turns with a body is not braked. In
/// the implicit step the terms stay symmetric and positive definite: each is the square of a difference.
struct StickingBodies {
  static constexpr bool there = true;
  Solids solids;
  BodyRows rows;
  float rate;            ///< nu dt times the share that sticks, m2
  float finest_support;  ///< of m_*
  /// Of d, the least s: as near as particles come to walls.
  static constexpr float nearest = 0.1f;

  /// Calls then(number, what the body takes of v in dt). First: of velocities, then of directions.
  template <bool First, class Then>
  SIM_FN void each(Vec4 at, Vec3 v, Then then) const {
    const float d = 0.5f * at.w;
    for_bodies_within(solids, xyz(at), d, [&](int b, const Body& body, const Body::Near& near) {
      const float steps =
          rate * face_share(body, xyz(at), near.distance) / (d * at_least(near.distance, nearest * d));
      const Vec3 slip = v - (First ? body.velocity_at(xyz(at)) : way_of(b, xyz(at)));
      then(b, steps * (slip - dot(slip, near.normal) * near.normal));
    });
  }
  SIM_FN Vec3 way_of(int b, Vec3 x) const {
    if (!rows.moves(b)) return {0, 0, 0};
    const BodyTurn p = rows.rows[b].direction;
    return p.along + cross(p.round, x - solids.bodies[b].centre);
  }
  /// What all of them take, which their rows are told.
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

/// Ends of the sums: what free bodies add, and the steps of all.
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

/// Tells bodies what they gained.
struct HearGained {
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
