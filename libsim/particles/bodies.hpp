#pragma once
/// Rigid bodies as obstacles for particles: distance, normal, and the share of a kernel inside the body.

#include "libsim/particles/mesh_grid.hpp"
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

/// Share of a ball of radius 1 with poly6's weights inside a sphere of radius r, and its slope with spiky's
/// weights; both are exact. q: distance of the ball's centre from the sphere's surface, 0 .. 1. For large r
/// they approach the half-space of libsim/particles/walls.hpp.
struct SphereShare {
  float q, r;

  /// The share of a shell of radius z inside is (1 - (z^2 + a^2 - r^2) / (2 z a)) / 2, a = q + r.
  SIM_FN float inside() const {
    const float a = q + r;
    const float far = at_most(q + 2 * r, 1.0f);
    const float odd = plain(far) - plain(q);
    const float even = third(far) - third(q) + q * (2 * r + q) * (first(far) - first(q));
    return 315.0f / 32 * odd - 315.0f / 64 * even / a;
  }
  /// -d inside / dq with spiky's weights.
  SIM_FN float slope() const {
    const float a = q + r;
    const float far = at_most(q + 2 * r, 1.0f);
    const float even =
        (a * a + r * r) * (spiky_first(far) - spiky_first(q)) - spiky_third(far) + spiky_third(q);
    return 15 * even / (a * a);
  }

 private:
  /// Integrals of z^2 (1 - z^2)^3, z (1 - z^2)^3, z^3 (1 - z^2)^3, z (1 - z)^3 and z^3 (1 - z)^3.
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
/// `half`. A box has radius 0; the others have half sides only along y. Or a mesh inside a box of half sides
/// `half`, with distances from a MeshGrid.
struct Body {
  Vec3 half;
  float radius;
  Vec3 centre;
  Vec4 turn;      ///< unit quaternion, from the body's axes to the world's
  Vec3 velocity;  ///< of the centre in this substep, m/s
  Vec3 spin;      ///< rad/s

  using Near = NearSurface;
  /// In the body's own axes.
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

  /// Share of the kernel of a particle at x inside the body, and its gradient (1/m) with the spiky kernel's
  /// slope; a particle inside counts as on the surface.
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
  /// For round surfaces, as a sphere of the same mean curvature: the side of a cylinder has half the
  /// curvature of its ends.
  SIM_FN float missing_round(Vec3 p, Near at, float h, Vec3& gradient) const {
    const float past_end = (fabsf(p.y) - half.y) / h;
    const float end = half.y > 0 ? at_most(at_least(0.5f + past_end, 0.0f), 1.0f) : 1.0f;
    const SphereShare share{at_least(at.distance / h, 0.0f), radius / (0.5f * (1 + end) * h)};
    gradient = -(share.slope() / h) * at.normal;
    return share.inside();
  }
  /// For a box, as the product of the shares along its three axes: exact for planes, and a quarter or an
  /// eighth at an edge or a corner.
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
  /// Share beyond a plane at the signed distance q, and minus its slope.
  SIM_FN static float beyond(float q) {
    const float inside = Walls::behind(at_most(fabsf(q), 1.0f));
    return q < 0 ? 1 - inside : inside;
  }
  SIM_FN static float slope_of(float q) { return Walls::slope(at_most(fabsf(q), 1.0f)); }
};

}  // namespace sim::SIM_BACKEND
