#pragma once
/// Rigid motions: x right, y up, z backwards; metres.

#include <cmath>

#include "tests/headset/openxr.hpp"

namespace simulated {

struct Vector {
  double x = 0, y = 0, z = 0;
};
inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A rotation as a unit quaternion.
struct Rotation {
  double w = 1;
  Vector v;
};
inline Rotation operator*(Rotation a, Rotation b) {
  return {a.w * b.w - (a.v.x * b.v.x + a.v.y * b.v.y + a.v.z * b.v.z),
          a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}
inline Vector turn(Rotation q, Vector a) {
  const Vector t = 2.0 * cross(q.v, a);
  return a + q.w * t + cross(q.v, t);
}
inline Rotation inverse(Rotation q) { return {q.w, -1.0 * q.v}; }

constexpr double radians_per_degree = 0.017453292519943295;
/// Yaw to the left, then pitch upwards, then roll to the left; degrees.
inline Rotation turned(double yaw, double pitch, double roll) {
  const auto about = [](double degrees, Vector axis) {
    const double half = 0.5 * degrees * radians_per_degree;
    return Rotation{std::cos(half), std::sin(half) * axis};
  };
  return about(yaw, {0, 1, 0}) * about(pitch, {1, 0, 0}) * about(roll, {0, 0, 1});
}

struct Pose {
  Rotation q;
  Vector p;
};
inline Pose operator*(const Pose& a, const Pose& b) { return {a.q * b.q, a.p + turn(a.q, b.p)}; }
inline Pose inverse(const Pose& a) {
  const Rotation q = inverse(a.q);
  return {q, -1.0 * turn(q, a.p)};
}

inline XrPosef to_xr(const Pose& a) {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {{f(a.q.v.x), f(a.q.v.y), f(a.q.v.z), f(a.q.w)}, {f(a.p.x), f(a.p.y), f(a.p.z)}};
}
inline Pose from_xr(const XrPosef& a) {
  const auto d = [](float x) { return static_cast<double>(x); };
  return {{d(a.orientation.w), {d(a.orientation.x), d(a.orientation.y), d(a.orientation.z)}},
          {d(a.position.x), d(a.position.y), d(a.position.z)}};
}
/// True if the specification accepts the pose: a quaternion within 1 % of length 1, and a finite position.
inline bool is_valid(const XrPosef& a) {
  const Pose pose = from_xr(a);
  const Vector v = pose.q.v;
  const double length = std::sqrt(pose.q.w * pose.q.w + v.x * v.x + v.y * v.y + v.z * v.z);
  return std::fabs(length - 1) <= 0.01 && std::isfinite(pose.p.x + pose.p.y + pose.p.z);
}

}  // namespace simulated
