#pragma once
/// Walls and obstacles together: the boundaries in scenes with obstacles.

#include "libsim/particles/bodies.hpp"
#include "libsim/particles/momentum.hpp"

namespace sim::SIM_BACKEND {

inline constexpr int most_bodies = 16;

/// Sum of what a body gave the water: mass in m_* times displacement in m, and its moment about the body's
/// centre in m_* m2.
struct BodySum {
  MassWay push, moment;
};

/// Records in kernels what bodies give the water.
struct BodyListener {
  BodySum* sums;
  const Body* bodies;
  float finest_support;
  float times;  ///< as in WallRecord

  /// Adds `push`, in m_* m, at a position.
  SIM_FN void add(int body, Vec3 at, Vec3 push) const {
    BodySum sum{};
    add_to(sum, body, at, push);
    add_at_once(body, sum);
  }
  /// The same, added to a local sum.
  SIM_FN void add_to(BodySum& sum, int body, Vec3 at, Vec3 push) const {
    sum.push.add(times, push);
    sum.moment.add(times, cross(at - bodies[body].centre, push));
  }
  SIM_FN void add_at_once(int body, const BodySum& sum) const {
    sums[body].push.add_at_once(sum.push);
    sums[body].moment.add_at_once(sum.moment);
  }
};

/// The functions of Walls, for walls and bodies together.
struct Solids {
  Walls walls;
  const Body* bodies;
  int count;
  float dt;                          ///< duration of the bodies' move to their positions, s
  const MeshGrid* meshes = nullptr;  ///< of all bodies; nullptr: no body is a mesh

  SIM_FN Body::Near near(int body, Vec3 x) const {
    const MeshGrid* mesh = mesh_of(meshes, body);
    if (!mesh) return bodies[body].near(x);
    const Body::Near here = mesh->near(bodies[body].to_body(x));
    return {here.distance, turned(bodies[body].turn, here.normal)};
  }
  SIM_FN float distance(int body, Vec3 x) const {
    const MeshGrid* mesh = mesh_of(meshes, body);
    return mesh ? mesh->near(bodies[body].to_body(x)).distance : bodies[body].distance(x);
  }
  /// Like Body::missing; a mesh's surface counts as a plane.
  SIM_FN float missing(int body, Vec3 x, float h, Vec3& gradient) const {
    if (!mesh_of(meshes, body)) return bodies[body].missing(x, h, gradient);
    gradient = {0, 0, 0};
    const Body::Near at = near(body, x);
    if (at.distance >= h) return 0;
    const float q = at_least(at.distance / h, 0.0f);
    gradient = -(Walls::slope(q) / h) * at.normal;
    return Walls::behind(q);
  }

  /// 1 - prod (1 - share) over walls and bodies.
  SIM_FN float missing(Vec3 x, float h, Vec3& gradient) const {
    float present = 1 - walls.missing(x, h, gradient);
    for (int b = 0; b < count; ++b) {
      Vec3 own;
      const float share = missing(b, x, h, own);
      gradient = (1 - share) * gradient + present * own;
      present *= 1 - share;
    }
    return 1 - present;
  }
  /// The part of the gradient above that comes from one body.
  SIM_FN Vec3 missing_gradient(int body, Vec3 x, float h) const {
    Vec3 own;
    Vec3 other;
    if (missing(body, x, h, own) <= 0) return {0, 0, 0};
    float present = 1 - walls.missing(x, h, other);
    for (int b = 0; b < count; ++b) {
      if (b != body) present *= 1 - missing(b, x, h, other);
    }
    return present * own;
  }
  /// Share of the kernel outside all bodies.
  SIM_FN float beside_bodies(Vec3 x, float h) const {
    float present = 1;
    Vec3 own;
    for (int b = 0; b < count; ++b) present *= 1 - missing(b, x, h, own);
    return present;
  }

  /// Signed distance to the nearest body's surface, and the index of that body; needs at least one body.
  SIM_FN float nearest_body(Vec3 x, int& body) const {
    float least = 3e38f;
    body = 0;
    for (int b = 0; b < count; ++b) {
      const float away = distance(b, x);
      if (away >= least) continue;
      least = away;
      body = b;
    }
    return least;
  }
  SIM_FN float nearest_body(Vec3 x) const {
    int body;
    return nearest_body(x, body);
  }
  SIM_FN float nearest(Vec3 x) const { return at_most(nearest_body(x), walls.nearest(x)); }
  SIM_FN bool holds(Vec3 x, float gap = 0) const { return walls.holds(x, gap) && nearest_body(x) >= gap; }

  /// Like Walls::hold_back. A body measures the distance at the start as if the particle had moved with it.
  /// If a body touches a wall, the way out of the body may lead into the wall: a particle without another way
  /// out stays where it was.
  template <class Record = NoRecord>
  SIM_FN bool hold_back(Vec3& x, Vec3 to, float gap, Record record = {}) const {
    const Vec3 from = x;
    bool held = false;
    for (int b = 0; b < count; ++b) {
      const Body& body = bodies[b];
      const Body::Near after = near(b, to);
      const float before = distance(b, fused(x, dt, body.velocity_at(x))) - gap;
      const float beyond = Walls::kept_distance * at_least(before, 0.0f) - (after.distance - gap);
      if (beyond <= 0) continue;
      record.body(b, to, beyond * after.normal);
      to += beyond * after.normal;
      held = true;
    }
    if (!walls.hold_back(x, to, gap, record)) return held;
    if (held) stay_out(x, from, record);
    return true;
  }

  /// Like Walls::project; walls are applied last, unless that would push a particle from outside into a body.
  template <class Record = NoRecord>
  SIM_FN bool project(Vec3& x, Vec3 from, float gap, Record record = {}) const {
    bool moved = false;
    for (int b = 0; b < count; ++b) {
      const Body::Near at = near(b, x);
      const float depth = gap - at.distance;
      if (depth <= 0) continue;
      record.body(b, x, depth * at.normal);
      x += depth * at.normal;
      moved = true;
    }
    if (!walls.project(x, from, gap, record)) return moved;
    if (moved) stay_out(x, from, record);
    return true;
  }

 private:
  template <class Record>
  SIM_FN void stay_out(Vec3& x, Vec3 from, Record record) const {
    int body;
    if (nearest_body(x, body) >= 0 || !holds(from)) return;
    record.body(body, x, from - x);
    x = from;
  }
};

/// The walls of a boundary.
SIM_FN const Walls& tank(const Walls& walls) { return walls; }
SIM_FN const Walls& tank(const Solids& solids) { return solids.walls; }

}  // namespace sim::SIM_BACKEND
