#include "libsim/scene/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/scene/mesh.hpp"
#include "libsim/scene/vector.hpp"

namespace sim {

namespace {

double reach(const Obstacle& o) {
  const Vector half = half_sides_m(o);
  return std::hypot(half[0], half[1], half[2]) + o.radius_m;
}

double depth(const Obstacle& one, const Vector& own, const Obstacle& other) {
  return one.radius_m - signed_distance(other, other.start, in_world(one.start, own));
}

/// Greatest depth in `other` of the part of `one` that lies around the edge begin .. end of its inner box
/// (half_sides_m()), by ternary search: along a straight line the distance from a convex body has only one
/// minimum.
double depth_of_edge(const Obstacle& one, const Vector& begin, const Vector& end, const Obstacle& other) {
  const auto at = [&](double s) {
    Vector own{};
    for (std::size_t k = 0; k < 3; ++k) own[k] = begin[k] + s * (end[k] - begin[k]);
    return depth(one, own, other);
  };
  double low = 0, high = 1;
  for (int k = 0; k < 40; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (at(a) >= at(b) ? high : low) = at(a) >= at(b) ? b : a;
  }
  return std::max({at(0), at((low + high) / 2), at(1)});
}

double depth_in(const Obstacle& one, const Obstacle& other) {
  double out = depth(one, {0, 0, 0}, other);
  if (one.mesh) {
    for (const Vector& place : one.mesh->places_m()) out = std::max(out, depth(one, place, other));
    return out;
  }
  const Vector half = half_sides_m(one);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 4; ++k) {
      Vector end = half;
      end[(axis + 1) % 3] *= k & 1 ? 1 : -1;
      end[(axis + 2) % 3] *= k & 2 ? 1 : -1;
      Vector begin = end;
      begin[axis] = -begin[axis];
      out = std::max(out, depth_of_edge(one, begin, end, other));
    }
  }
  return out;
}

}  // namespace

double overlap_m(const Obstacle& one, const Obstacle& other) {
  const Vector& a = one.start.centre_m;
  const Vector& b = other.start.centre_m;
  const double apart = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) - reach(one) - reach(other);
  if (apart >= 0) return -apart;
  return std::max(depth_in(one, other), depth_in(other, one));
}

}  // namespace sim
