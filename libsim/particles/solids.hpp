#pragma once
/// Rigid bodies as obstacles for particles: distance, normal, and the share of a kernel inside the body.
/// Solids combines walls and bodies into the boundary of scenes with obstacles.

#include "libsim/particles/mesh_grid.hpp"
#include "libsim/particles/momentum.hpp"
#include "libsim/particles/walls.hpp"

namespace sim::SIM_BACKEND {

SIM_FN Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// v rotated by the unit quaternion q.
SIM_FN Vec3 turned(Vec4 q, Vec3 v) {
  const Vec3 u = xyz(q);
  const Vec3 t = cross(u, v);
  return v + (2 * q.w) * t + 2.0f * cross(u, t);
}
SIM_FN Vec4 turned_back(Vec4 q) { return {-q.x, -q.y, -q.z, q.w}; }

/// Share of a particle's kernel (poly6, radius 1) that lies inside a sphere of radius r, and its slope for
/// the spiky kernel; both are exact. q: distance of the particle from the sphere's surface, 0 .. 1. For large
/// r both approach the values of a half-space (libsim/particles/walls.hpp).
struct SphereShare {
  float q, r;

  /// Share inside the sphere, integrated over shells around the particle. Of a shell of radius z the share (1
  /// - (z^2 + a^2 - r^2) / (2 z a)) / 2 is inside, a = q + r.
  SIM_FN float inside() const {
    const float a = q + r;
    const float far = at_most(q + 2 * r, 1.0f);
    const float odd = plain(far) - plain(q);
    const float even = third(far) - third(q) + q * (2 * r + q) * (first(far) - first(q));
    return 315.0f / 32 * odd - 315.0f / 64 * even / a;
  }
  /// Minus the derivative of the share with respect to q, for the spiky kernel.
  SIM_FN float slope() const {
    const float a = q + r;
    const float far = at_most(q + 2 * r, 1.0f);
    const float even =
        (a * a + r * r) * (spiky_first(far) - spiky_first(q)) - spiky_third(far) + spiky_third(q);
    return 15 * even / (a * a);
  }

 private:
  /// Antiderivatives of z^2 (1 - z^2)^3, z (1 - z^2)^3, z^3 (1 - z^2)^3, z (1 - z)^3 and z^3 (1 - z)^3, in
  /// the order of the functions.
  SIM_FN static float plain(float z) {
    const float z2 = z * z;
    return z * z2 * (1.0f / 3 + z2 * (-0.6f + z2 * (3.0f / 7 - z2 / 9)));
  }
  SIM_FN static float first(float z) {
    const float v = 1 - z * z;
    return -0.125f * v * v * v * v;
  }
  SIM_FN static float third(float z) {
    const float v = 1 - z * z;
    return v * v * v * v * (0.1f * v - 0.125f);
  }
  SIM_FN static float spiky_first(float z) {
    const float u = 1 - z;
    return -u * u * u * u * (0.25f - 0.2f * u);
  }
  SIM_FN static float spiky_third(float z) {
    const float u = 1 - z;
    return -u * u * u * u * (0.25f + u * (-0.6f + u * (0.5f - u / 7)));
  }
};

/// A sphere, a capsule along its own y axis, or a box: all points within `radius` of a box with half sides
/// `half`. A box has radius 0; spheres and capsules have half sides 0 along x and z. A mesh lies inside a box
/// of half sides `half`; its distances come from a MeshGrid.
struct Body {
  Vec3 half;
  float radius;
  Vec3 centre;
  Vec4 turn;      ///< unit quaternion, from the body's axes to the world's
  Vec3 velocity;  ///< of the centre in this substep, m/s
  Vec3 spin;      ///< rad/s

  using Near = NearSurface;
  /// Distance and normal of the surface at p, in the body's own axes.
  SIM_FN Near near_here(Vec3 p) const {
    const Vec3 beyond{fabsf(p.x) - half.x, fabsf(p.y) - half.y, fabsf(p.z) - half.z};
    const Vec3 sign{p.x < 0 ? -1.0f : 1.0f, p.y < 0 ? -1.0f : 1.0f, p.z < 0 ? -1.0f : 1.0f};
    const Vec3 out{at_least(beyond.x, 0.0f), at_least(beyond.y, 0.0f), at_least(beyond.z, 0.0f)};
    const float away = length(out);
    if (away > 0) return {away - radius, (1 / away) * Vec3{sign.x * out.x, sign.y * out.y, sign.z * out.z}};
    if (beyond.x > beyond.y && beyond.x > beyond.z) return {beyond.x - radius, {sign.x, 0, 0}};
    if (beyond.y > beyond.z) return {beyond.y - radius, {0, sign.y, 0}};
    return {beyond.z - radius, {0, 0, sign.z}};
  }
  SIM_FN Vec3 to_body(Vec3 x) const { return turned(turned_back(turn), x - centre); }
  SIM_FN Near near(Vec3 x) const {
    const Near here = near_here(to_body(x));
    return {here.distance, turned(turn, here.normal)};
  }
  SIM_FN float distance(Vec3 x) const { return near_here(to_body(x)).distance; }
  SIM_FN Vec3 velocity_at(Vec3 x) const { return velocity + cross(spin, x - centre); }

  /// Share of a particle's kernel that lies inside the body, and its gradient (1/m) with the spiky kernel's
  /// slope; a particle inside the body counts as if it were on the surface.
  SIM_FN float missing(Vec3 x, float h, Vec3& gradient) const {
    gradient = {0, 0, 0};
    const Vec3 p = to_body(x);
    const Near at = near_here(p);
    if (at.distance >= h) return 0;
    Vec3 here{0, 0, 0};
    const float out = radius > 0 ? missing_round(p, at, h, here) : missing_box(p, at, h, here);
    gradient = turned(turn, here);
    return out;
  }

 private:
  /// missing() of a sphere or a capsule, from a sphere of the same mean curvature: the side of a capsule has
  /// half the mean curvature of its ends.
  SIM_FN float missing_round(Vec3 p, Near at, float h, Vec3& gradient) const {
    const float past_end = (fabsf(p.y) - half.y) / h;
    const float end = half.y > 0 ? at_most(at_least(0.5f + past_end, 0.0f), 1.0f) : 1.0f;
    const SphereShare share{at_least(at.distance / h, 0.0f), radius / (0.5f * (1 + end) * h)};
    gradient = -(share.slope() / h) * at.normal;
    return share.inside();
  }
  /// missing() of a box: the product of the shares along its three axes. It is exact beside a face far from
  /// edges. On the surface it is a quarter at an edge and an eighth at a corner.
  SIM_FN float missing_box(Vec3 p, Near at, float h, Vec3& gradient) const {
    if (at.distance < 0) p += -at.distance * at.normal;
    float sx, sy, sz;
    const float x = along(p.x, half.x, h, sx);
    const float y = along(p.y, half.y, h, sy);
    const float z = along(p.z, half.z, h, sz);
    gradient = {sx * y * z, x * sy * z, x * y * sz};
    return x * y * z;
  }
  SIM_FN static float along(float p, float half, float h, float& slope) {
    const float low = (fabsf(p) - half) / h;
    const float high = (fabsf(p) + half) / h;
    slope = (p < 0 ? -1 : 1) * (slope_of(high) - slope_of(low)) / h;
    return beyond(low) - beyond(high);
  }
  /// Share of a kernel beyond a plane at the signed distance q, in support radii; slope_of() is minus its
  /// slope.
  SIM_FN static float beyond(float q) {
    const float inside = Walls::behind(at_most(fabsf(q), 1.0f));
    return q < 0 ? 1 - inside : inside;
  }
  SIM_FN static float slope_of(float q) { return Walls::slope(at_most(fabsf(q), 1.0f)); }
};

inline constexpr int most_bodies = 16;

/// Sum of a body's pushes on the water: mass in m_* (the mass of a particle of level 0) times displacement in
/// m, and the moment about the body's centre in m_* m2.
struct BodySum {
  MassWay push, moment;
};

/// A part of a body's surface on which pushes are measured: the part inside a box in the body's own axes. A
/// side of the box at or beyond the body's end counts as infinitely far away.
struct BodyPatch {
  int body;
  Vec3 low, high;

  /// Share of a square that lies inside the patch. The square has the edge `side` and the normal `normal`;
  /// its centre is the surface point `at`, in the body's own axes.
  SIM_FN float share(Vec3 at, Vec3 normal, float side) const {
    return along(at.x, normal.x, side, low.x, high.x) * along(at.y, normal.y, side, low.y, high.y) *
           along(at.z, normal.z, side, low.z, high.z);
  }

 private:
  /// Share of the square's projection on one axis that lies between low and high. `normal`: the component of
  /// the square's normal along that axis; at 1 the projection is a point and counts as 1e-3 sides long.
  SIM_FN static float along(float at, float normal, float side, float low, float high) {
    const float flat = sqrtf(at_least(1 - normal * normal, 0.0f));
    return share_within(at, 0.5f * side * at_least(flat, 1e-3f), low, high);
  }
};
struct PatchSum {
  BodySum given;
  /// wetted area: the sum, over the particles within their support h of the body, of d^2 times the share of a
  /// square of edge d, projected onto the body, that lies in the patch; d = h / 2. In units of d_*^2 /
  /// CellWater::fixed_point, with d_* the spacing of the finest particles
  std::uint64_t wet;
};
/// All patches of a scene; most scenes have none.
struct BodyPatches {
  const BodyPatch* patches;
  PatchSum* sums;
  int count;
  const MeshGrid* meshes;  ///< of all bodies; nullptr: no body is a mesh

  /// Projects a square of edge `side` at x onto the body. Calls hear(sum, share) for each patch that contains
  /// a share of the square.
  template <class Hear>
  SIM_FN void at(const Body& its, int body, Vec3 x, float side, Hear hear) const {
    const Vec3 p = its.to_body(x);
    const MeshGrid* mesh = mesh_of(meshes, body);
    const NearSurface near = mesh ? mesh->near(p) : its.near_here(p);
    for (int k = 0; k < count; ++k) {
      if (patches[k].body != body) continue;
      const float share = patches[k].share(p - near.distance * near.normal, near.normal, side);
      if (share > 0) hear(sums[k], share);
    }
  }
};

/// Records the pushes of bodies on the water, for kernels.
struct BodyListener {
  BodySum* sums;
  const Body* bodies;
  float finest_support;
  /// weight of a push in one projection: 1 plus the shares of it that the substep's later projections add
  /// again, because each repeats a share of the step before (SolverParameters::momentum)
  float times;
  BodyPatches patches;

  /// Adds the push of a body (mass in m_*, as BodySum, times displacement in m) on a particle; it acts at the
  /// position `at`.
  SIM_FN void add(int body, Vec4 particle, Vec3 at, Vec3 push) const {
    BodySum sum{};
    add_to(sum, body, at, push);
    add_at_once(body, sum);
    if (patches.count > 0) add_to_patches(body, xyz(particle), 0.5f * particle.w, at, push);
  }
  /// Adds a push only to the body's patches, each in proportion to its share of a square on the surface below
  /// `beside`; `side`: edge of the square, m.
  SIM_FN void add_to_patches(int body, Vec3 beside, float side, Vec3 at, Vec3 push) const {
    patches.at(bodies[body], body, beside, side, [&](PatchSum& patch, float share) {
      BodySum sum{};
      add_to(sum, body, at, share * push);
      patch.given.push.add_at_once(sum.push);
      patch.given.moment.add_at_once(sum.moment);
    });
  }
  SIM_FN void add_to(BodySum& sum, int body, Vec3 at, Vec3 push) const {
    sum.push.add(times, push);
    sum.moment.add(times, cross(at - bodies[body].centre, push));
  }
  SIM_FN void add_at_once(int body, const BodySum& sum) const {
    sums[body].push.add_at_once(sum.push);
    sums[body].moment.add_at_once(sum.moment);
  }
};

/// Walls and bodies together, with the functions of Walls.
struct Solids {
  Walls walls;
  const Body* bodies;
  int count;
  float dt;                          ///< time in which the bodies moved to their present positions, s
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

  /// Share of the kernel inside walls and bodies, 1 - prod (1 - share), and its gradient, 1/m.
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
  /// The part of missing()'s gradient that comes from one body, 1/m.
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

  /// Like Walls::hold_back, for walls and bodies. The distance from a moving body before the move is measured
  /// as if the particle had moved with the body. Near a body that touches a wall, the corrections by wall and
  /// body can contradict each other. A particle that would then end inside a body stays at its old position,
  /// if that is inside the walls and outside all bodies.
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

  /// Like Walls::project, for bodies and then walls. If both a body and a wall moved the particle and it
  /// would end inside a body, it returns to `from`, provided that `from` is inside the walls and outside all
  /// bodies.
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

/// Returns the walls of a boundary, without obstacles.
SIM_FN const Walls& tank(const Walls& walls) { return walls; }
SIM_FN const Walls& tank(const Solids& solids) { return solids.walls; }

}  // namespace sim::SIM_BACKEND
