#pragma once
/// Vectors of three doubles, for geometry on the host.

#include <array>
#include <cmath>

namespace sim {

using Vector = std::array<double, 3>;

/// Largest coordinate of a scene, m: floats resolve 1 mm up to this distance.
constexpr double farthest_m = 1e4;

inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
/// a + share b.
inline Vector sum(const Vector& a, double share, const Vector& b) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace sim
