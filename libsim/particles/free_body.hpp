#pragma once
/// Rigid bodies moved by water and gravity. Masses are in m_*, the mass of a particle of level 0.

#include "libsim/particles/particles.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Dynamic state of a body; its position is in Body. m_* is the mass of a particle of level 0.
struct FreeBody {
  float mass;     ///< m_*; 0: the body is not free
  float volume;   ///< in units of the volume m_* / rho_0
  Vec3 inertia;   ///< about the body's own axes, m_* m2
  Vec3 momentum;  ///< m_* m/s
  Vec3 spin;      ///< angular momentum about the centre, m_* m2/s
  /// Force and torque from the water, smoothed over substeps (Push in free_bodies.cpp), and applied in the
  /// next substep: m_* m/s2 and m_* m2/s2.
  Vec3 force, torque;
  /// sums over all substeps: what the water gave, minus `force` and `torque` of that substep
  Vec3 force_left, torque_left;
  Vec3 by_walls;  ///< momentum received from walls in this frame, m_* m/s
  /// the body's pushes on the water in this frame, summed up to the end of the last substep
  /// (ObstacleState::sums, without the pushes of effects)
  BodySum counted;
  BodySum counted_of_effects;  ///< the same sum for the pushes of effects
};

/// A body's motion: velocity of the centre, m/s, and angular velocity, rad/s.
struct BodyTurn {
  Vec3 along, round;
};
/// A body in a system of equations for velocities, solved by conjugate gradients
/// (libsim/solver/effects/sticking.hpp). gained: the solution so far. residual, direction, and bent = A
/// direction: vectors of the conjugate gradients, with the system's matrix A. For a body that is not free,
/// each BodyTurn contains momentum, in m_* m/s with m_* the mass of a particle of level 0, and its moment,
/// m_* m2/s, instead.
struct BodyRow {
  BodyTurn gained, residual, direction, bent;
  /// momentum, and its moment about the centre, received from particles in one pass, in BodyRows::unit
  Momentum push, moment;
};

/// The quaternion q, rotated by the rotation vector `way` in world axes, rad.
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

/// Angular velocity for an angular momentum at this attitude, rad/s.
SIM_FN Vec3 spin_of(const FreeBody& free, Vec4 turn, Vec3 momentum) {
  const Vec3 own = turned(turned_back(turn), momentum);
  return turned(turn, {own.x / free.inertia.x, own.y / free.inertia.y, own.z / free.inertia.z});
}

/// Angular momentum for an angular velocity at this attitude, m_* m2/s with m_* the mass of a particle of
/// level 0; inverse of spin_of().
SIM_FN Vec3 momentum_of(const FreeBody& free, Vec4 turn, Vec3 spin) {
  const Vec3 own = turned(turned_back(turn), spin);
  return turned(turn, {own.x * free.inertia.x, own.y * free.inertia.y, own.z * free.inertia.z});
}

/// Rotates a free body for dt without torque, at the angular velocity that it has at the middle of dt.
SIM_FN void turn_on(Body& body, const FreeBody& free, float dt) {
  const Vec4 halfway = turned_by(body.turn, (0.5f * dt) * spin_of(free, body.turn, free.spin));
  body.spin = spin_of(free, halfway, free.spin);
  body.turn = turned_by(body.turn, dt * body.spin);
}

/// Removes the momentum that would carry a free body through the tank's walls in dt. Contact points are the
/// corners of the body's inner box (half sides Body::half), each a ball of its radius, or a mesh's contacts;
/// contacts are inelastic and frictionless. Outlets let no body through.
struct WallContact {
  /// maximum number of sweeps over all contact points; the first sweep without a push is the last
  static constexpr int sweeps = 8;
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
  /// Stops the contact point so that it does not pass the wall within dt. True if a push was necessary.
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
  /// Displacement that moves a body that is partly beyond walls back inside, m; zero if it is inside.
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

/// Forces on a free body other than contacts: applies a substep's gravity and the water's force from the
/// previous substep, then limits the body's speed.
struct BodyDrive {
  Guards* guards;
  Vec3 lift;  ///< minus the acceleration of gravity, m/s2
  float dt, most_speed;
  bool first;  ///< first substep of the frame

  SIM_FN void operator()(FreeBody& it) const {
    if (first) it.by_walls = {0, 0, 0};
    if (first) it.counted = it.counted_of_effects = {};
    it.momentum += dt * it.force;
    it.momentum = it.momentum - dt * (it.mass * lift);
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
