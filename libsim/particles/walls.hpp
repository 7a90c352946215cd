#pragma once
/// Walls of a tank as particles meet them.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Half-space dot(normal, x) >= offset that holds the fluid.
struct Plane {
  Vec3 normal;
  float offset;
};

/// Who does not listen to what walls do to a particle.
struct NobodyHears {
  SIM_FN void operator()(int, float) const {}
};

/// Walls of a tank as signed distances.
struct Walls {
  static constexpr int most = 8;
  Plane planes[most];
  int count;

  /// Share of a particle's kernel that lies behind the walls, 1 - prod (1 - f(s_k / h)), and its gradient
  /// (1/m) with the spiky kernel's slope. Summing half-spaces instead would give 1.5 in a corner where 0.875
  /// is missing. f(q) = 315/256 int_q^1 (1 - z^2)^4 dz for poly6; slope 30/h (u^4/4 - u^5/5), u = 1 - q, for
  /// spiky; both are exact.
  SIM_FN float missing(Vec3 x, float h, Vec3& gradient) const {
    float present = 1;
    gradient = {0, 0, 0};
    for (int k = 0; k < count; ++k) {
      const float q = (dot(planes[k].normal, x) - planes[k].offset) / h;
      if (q >= 1) continue;
      const float inside = fmaxf(q, 0.0f);
      const float kept = 1 - behind(inside);
      // Product rule; the wall's share falls along its normal.
      gradient = kept * gradient - (present * slope(inside) / h) * planes[k].normal;
      present *= kept;
    }
    return 1 - present;
  }
  SIM_FN static float behind(float q) {
    const float q2 = q * q;
    const float integral = q * (1 + q2 * (-4.0f / 3 + q2 * (6.0f / 5 + q2 * (-4.0f / 7 + q2 / 9))));
    return 0.5f - 315.0f / 256 * integral;
  }
  SIM_FN static float slope(float q) {
    const float u = 1 - q;
    const float u4 = u * u * u * u;
    return 30 * u4 * (0.25f - 0.2f * u);
  }

  /// The part of `gradient` above that wall k has, along its normal: <= 0.
  SIM_FN float missing_slope(int k, Vec3 x, float h) const {
    float out = -slope_at(k, x, h) / h;
    for (int other = 0; other < count; ++other) {
      if (other != k) out *= 1 - behind(distance_in_h(other, x, h));
    }
    return out;
  }
  SIM_FN float distance_in_h(int k, Vec3 x, float h) const {
    return fminf(fmaxf((dot(planes[k].normal, x) - planes[k].offset) / h, 0.0f), 1.0f);
  }
  SIM_FN float slope_at(int k, Vec3 x, float h) const { return slope(distance_in_h(k, x, h)); }

  /// Signed distance to the nearest wall's plane, m.
  SIM_FN float nearest(Vec3 x) const {
    float least = 3e38f;
    for (int k = 0; k < count; ++k) least = fminf(least, dot(planes[k].normal, x) - planes[k].offset);
    return least;
  }

  /// True where x lies at least `gap` inside every wall.
  SIM_FN bool holds(Vec3 x, float gap = 0) const {
    for (int k = 0; k < count; ++k) {
      if (dot(planes[k].normal, x) < planes[k].offset + gap) return false;
    }
    return true;
  }

  /// Takes x, which lies inside the walls, on its way `to`, but over at most a share of its distance from a
  /// wall (`gap` before it): what moves at one speed keeps its order, where a clamp would lay layers on one
  /// plane. True when it had to hold back; heard(wall, way in m) is told by which wall and how much.
  template <class Heard = NobodyHears>
  SIM_FN bool hold_back(Vec3& x, Vec3 to, float gap, Heard heard = {}) const {
    bool held = false;
    for (int k = 0; k < count; ++k) {
      const float border = planes[k].offset + gap;
      const float least = kept_distance * fmaxf(dot(planes[k].normal, x) - border, 0.0f);
      const float beyond = least - (dot(planes[k].normal, to) - border);
      if (beyond <= 0) continue;
      to += beyond * planes[k].normal;
      heard(k, beyond);
      held = true;
    }
    x = to;
    return held;
  }
  static constexpr float kept_distance = 0.25f;

  /// Moves x to at least `gap` inside every wall; true when it had to. heard: as above.
  template <class Heard = NobodyHears>
  SIM_FN bool project(Vec3& x, float gap, Heard heard = {}) const {
    bool moved = false;
    for (int k = 0; k < count; ++k) {
      const float depth = planes[k].offset + gap - dot(planes[k].normal, x);
      if (depth <= 0) continue;
      x += depth * planes[k].normal;
      heard(k, depth);
      moved = true;
    }
    return moved;
  }
};

}  // namespace sim::SIM_BACKEND
