#pragma once
/// Rigid bodies that the water and gravity move. Masses are in m_*.

#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// What moves a body, beside its place (Body).
struct FreeBody {
  float mass;     ///< m_*; 0: the body is not free
  float volume;   ///< in that of m_*
  Vec3 inertia;   ///< about its own axes, m_* m2
  Vec3 momentum;  ///< m_* m/s
  Vec3 spin;      ///< angular momentum about the centre, m_* m2/s
  /// Of the water, as the body follows it in the next substep: m_* m/s2 and m_* m2/s2.
  Vec3 force, torque;
  Vec3 force_left, torque_left;  ///< what it has yet to follow
  Vec3 by_walls;                 ///< what walls gave it in this frame, m_* m/s
  BodySum counted;               ///< of this frame's sums, by the substeps before
  BodySum counted_of_effects;    ///< the same of what effects gave
};

/// Velocity of the centre, m/s, and turning, rad/s.
struct BodyTurn {
  Vec3 along, round;
};
/// A body in a system of equations for velocities (libsim/solver/effects/sticking.hpp). Of one that is not
/// free the turns are momentum, m_* m/s, and its moment.
struct BodyRow {
  BodyTurn gained, residual, direction, bent;
  Momentum push, moment;  ///< taken from particles in one pass, in units of BodyRows
};

/// q turned by the way of a turn about the world's axes, rad.
SIM_FN Vec4 turned_by(Vec4 q, Vec3 way) {
  const float angle = length(way);
  const float s = angle > 1e-6f ? sinf(0.5f * angle) / angle : 0.5f;
  const Vec3 u = s * way;
  const float w = cosf(0.5f * angle);
  const Vec3 v = xyz(q);
  const Vec3 part = w * v + q.w * u + cross(u, v);
  const Vec4 out = with_w(part, w * q.w - dot(u, v));
  const float scale = 1 / sqrtf(dot(part, part) + out.w * out.w);
  return with_w(scale * part, scale * out.w);
}

/// What an angular momentum does to a body of this attitude, rad/s.
SIM_FN Vec3 spin_of(const FreeBody& free, Vec4 turn, Vec3 momentum) {
  const Vec3 own = turned(turned_back(turn), momentum);
  return turned(turn, {own.x / free.inertia.x, own.y / free.inertia.y, own.z / free.inertia.z});
}

/// The reverse: of a turning, rad/s.
SIM_FN Vec3 momentum_of(const FreeBody& free, Vec4 turn, Vec3 spin) {
  const Vec3 own = turned(turned_back(turn), spin);
  return turned(turn, {own.x * free.inertia.x, own.y * free.inertia.y, own.z * free.inertia.z});
}

/// Turns a body for dt as nothing holds it, with the spin of the middle of the way.
SIM_FN void turn_on(Body& body, const FreeBody& free, float dt) {
  const Vec4 halfway = turned_by(body.turn, (0.5f * dt) * spin_of(free, body.turn, free.spin));
  body.spin = spin_of(free, halfway, free.spin);
  body.turn = turned_by(body.turn, dt * body.spin);
}

/// Takes from a free body's momentum what would carry it through the tank's walls in dt. Contacts are those
/// of the corners of the box round which the body lies, each a ball of its radius, or of a mesh's contacts;
/// they are inelastic and without friction. Outlets let no body through.
struct WallContact {
  static constexpr int sweeps = 8;  ///< over all contacts, in which those of one body agree
  const Walls& walls;
  const Body& body;
  FreeBody& free;
  float dt;
  const MeshGrid* mesh = nullptr;

  SIM_FN int corners() const { return mesh ? mesh->contact_count : 8; }
  SIM_FN Vec3 arm(int corner) const {
    if (mesh) return turned(body.turn, mesh->contacts[corner]);
    const Vec3 h = body.half;
    return turned(body.turn, {corner & 1 ? h.x : -h.x, corner & 2 ? h.y : -h.y, corner & 4 ? h.z : -h.z});
  }
  SIM_FN void stop() const {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      bool met = false;
      for (int k = 0; k < walls.count; ++k) {
        for (int c = 0; c < corners(); ++c)
          met = stop(walls.planes[k].normal, walls.distance(k, body.centre), arm(c)) || met;
      }
      if (!met) return;
    }
  }
  /// The contact may come as near as the wall within dt; was it to be stopped?
  SIM_FN bool stop(Vec3 normal, float away, Vec3 arm) const {
    const float gap = away + dot(normal, arm) - body.radius;
    const Vec3 lever = cross(arm, normal);
    const Vec3 turns = spin_of(free, body.turn, lever);
    const Vec3 spin = spin_of(free, body.turn, free.spin);
    const float speed = dot(normal, (1 / free.mass) * free.momentum + cross(spin, arm));
    const float excess = -speed - at_least(gap, 0.0f) / dt;
    if (excess <= 0) return false;
    const float push = excess / (1 / free.mass + dot(lever, turns));
    free.momentum += push * normal;
    free.by_walls += push * normal;
    free.spin += push * lever;
    return true;
  }
  /// How far beyond the walls the body is, as the way back.
  SIM_FN Vec3 way_back() const {
    Vec3 out{0, 0, 0};
    for (int k = 0; k < walls.count; ++k) {
      float depth = 0;
      const float away = walls.distance(k, body.centre);
      for (int c = 0; c < corners(); ++c)
        depth = at_least(body.radius - away - dot(walls.planes[k].normal, arm(c)), depth);
      out += depth * walls.planes[k].normal;
    }
    return out;
  }
};

}  // namespace sim::SIM_BACKEND
