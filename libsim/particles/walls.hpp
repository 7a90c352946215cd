#pragma once
/// Walls of a tank as boundaries for particles.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Share of the interval at - half .. at + half that lies between low and high.
SIM_FN float share_within(float at, float half, float low, float high) {
  return fmaxf(fminf(at + half, high) - fmaxf(at - half, low), 0.0f) / (2 * half);
}

/// Half-space dot(normal, x) >= offset that contains the fluid.
struct Plane {
  Vec3 normal;
  float offset;
};

/// A hole in a plane of Walls, given by the box low .. high around it; the box is infinite across the plane.
struct Opening {
  int plane;
  Vec3 low, high;

  SIM_FN bool holds(Vec3 x) const {
    return x.x >= low.x && x.y >= low.y && x.z >= low.z && x.x <= high.x && x.y <= high.y && x.z <= high.z;
  }
};

/// Record that ignores corrections by walls and bodies.
struct NoRecord {
  SIM_FN void operator()(int, float) const {}
  SIM_FN void body(int, Vec3, Vec3) const {}
};

/// Walls of a tank as planes with signed distances. In front of an opening its plane does not act. Water
/// reaches the far side of a plane only through its openings; the plane does not act on such water either.
struct Walls {
  static constexpr int most = 8;
  static constexpr int most_openings = 4;
  Plane planes[most];  ///< in the order of sim::Wall
  int count;
  Opening openings[most_openings];
  int opening_count;

  bool have_lid() const { return count > 5; }
  SIM_FN float distance(int plane, Vec3 x) const {
    return dot(planes[plane].normal, x) - planes[plane].offset;
  }
  /// True if x is in front of an opening in this plane.
  SIM_FN bool opens(int plane, Vec3 x) const {
    for (int o = 0; o < opening_count; ++o) {
      if (openings[o].plane == plane && openings[o].holds(x)) return true;
    }
    return false;
  }
  /// True if x is on the far side of a plane that has an opening.
  SIM_FN bool through(int plane, Vec3 x) const {
    for (int o = 0; o < opening_count; ++o) {
      if (openings[o].plane == plane) return distance(plane, x) < 0;
    }
    return false;
  }
  SIM_FN bool through(Vec3 x) const {
    for (int o = 0; o < opening_count; ++o) {
      if (distance(openings[o].plane, x) < 0) return true;
    }
    return false;
  }
  /// True if the plane does not act on a particle at x. Only valid near and beyond the plane.
  SIM_FN bool absent(int plane, Vec3 x) const {
    return opening_count > 0 && (through(plane, x) || opens(plane, x));
  }
  /// True if the plane does not act on a move from `from` to `to`. Only valid near and beyond the plane.
  SIM_FN bool lets(int plane, Vec3 from, Vec3 to) const {
    if (opening_count == 0) return false;
    if (through(plane, from)) return true;
    const float before = distance(plane, from);
    const float after = distance(plane, to);
    // Point where the straight path crosses the plane.
    return opens(plane, after < 0 ? from + (before / (before - after)) * (to - from) : to);
  }

  /// Share of a particle's kernel behind the walls, 1 - prod (1 - f(s_k / h)) with the distance s_k from wall
  /// k, and its gradient (1/m) with the spiky kernel's slope. Summing half-spaces instead would give 1.5 in a
  /// corner where 0.875 is missing. f(q) = 315/256 int_q^1 (1 - z^2)^4 dz for poly6; slope 30/h (u^4/4 -
  /// u^5/5), u = 1 - q, for spiky; both are exact.
  SIM_FN float missing(Vec3 x, float h, Vec3& gradient) const {
    float present = 1;
    gradient = {0, 0, 0};
    for (int k = 0; k < count; ++k) {
      const float q = (dot(planes[k].normal, x) - planes[k].offset) / h;
      if (q >= 1) continue;
      if (absent(k, x)) continue;
      const float inside = at_least(q, 0.0f);
      const float kept = 1 - behind(inside);
      // Product rule; the wall's share decreases along its normal.
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

  /// The part of missing()'s gradient that comes from wall k, along its normal, 1/m: <= 0.
  SIM_FN float missing_slope(int k, Vec3 x, float h) const {
    float out = -slope_at(k, x, h) / h;
    for (int other = 0; other < count; ++other) {
      if (other != k) out *= 1 - behind(distance_in_h(other, x, h));
    }
    return out;
  }
  SIM_FN float distance_in_h(int k, Vec3 x, float h) const {
    if (absent(k, x)) return 1;
    return at_most(at_least((dot(planes[k].normal, x) - planes[k].offset) / h, 0.0f), 1.0f);
  }
  SIM_FN float slope_at(int k, Vec3 x, float h) const { return slope(distance_in_h(k, x, h)); }

  /// Signed distance to the nearest wall's plane, m.
  SIM_FN float nearest(Vec3 x) const {
    float least = 3e38f;
    for (int k = 0; k < count; ++k) least = at_most(dot(planes[k].normal, x) - planes[k].offset, least);
    return least;
  }

  /// True if x is at least `gap` inside every wall, except in front of openings.
  SIM_FN bool holds(Vec3 x, float gap = 0) const {
    for (int k = 0; k < count; ++k) {
      if (dot(planes[k].normal, x) < planes[k].offset + gap && !opens(k, x)) return false;
    }
    return true;
  }

  /// Moves x, which is inside the walls, to `to`, but keeps at least the share kept_distance of its distance
  /// from each wall, measured from `gap` in front of the wall. So particles of equal speed keep their order,
  /// whereas a clamp would put layers on one plane. True if a wall held x back; calls record(wall, distance
  /// in m) for each such wall.
  template <class Record = NoRecord>
  SIM_FN bool hold_back(Vec3& x, Vec3 to, float gap, Record record = {}) const {
    bool held = false;
    for (int k = 0; k < count; ++k) {
      const float border = planes[k].offset + gap;
      const float least = kept_distance * at_least(dot(planes[k].normal, x) - border, 0.0f);
      const float beyond = least - (dot(planes[k].normal, to) - border);
      if (beyond <= 0 || lets(k, x, to)) continue;
      to += beyond * planes[k].normal;
      record(k, beyond);
      held = true;
    }
    x = to;
    return held;
  }
  static constexpr float kept_distance = 0.25f;

  /// Moves x, which came from `from`, to at least `gap` inside every wall; true if it was moved. Calls
  /// record(wall, distance in m) for each wall that moved it.
  template <class Record = NoRecord>
  SIM_FN bool project(Vec3& x, Vec3 from, float gap, Record record = {}) const {
    bool moved = false;
    for (int k = 0; k < count; ++k) {
      const float depth = planes[k].offset + gap - dot(planes[k].normal, x);
      if (depth <= 0 || lets(k, from, x)) continue;
      x += depth * planes[k].normal;
      record(k, depth);
      moved = true;
    }
    return moved;
  }
};

}  // namespace sim::SIM_BACKEND
