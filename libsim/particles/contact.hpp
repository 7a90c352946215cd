#pragma once
/// Contacts of rigid bodies with each other and with the tank's walls.

#include "libsim/particles/free_body.hpp"

namespace sim::SIM_BACKEND {

/// A contact of a body with another body or with a wall.
struct Contact {
  Vec3 at;
  Vec3 normal;  ///< from the other body or the wall towards the body
  float gap;    ///< distance between the surfaces, m; negative: penetration depth
  float ahead;  ///< smallest gap until the substep's end without contact forces, m
};

/// The points of a body that are tested for contacts. Of a sphere, capsule or box: the corners of its inner
/// box (half sides Body::half), and on each edge of this box the point nearest to the other body. Each point
/// is the centre of a ball of the body's radius. Of a mesh: MeshGrid::contacts.
struct Feelers {
  const Body& body;
  const MeshGrid* mesh;  ///< nullptr: the body is not a mesh

  static constexpr int most_of_shapes = 20;

  SIM_FN bool is_box() const { return body.half.x > 0; }
  SIM_FN int corners() const {
    if (mesh) return mesh->contact_count;
    return is_box() ? 8 : body.half.y > 0 ? 2 : 1;
  }
  SIM_FN int edges() const { return mesh || body.half.y == 0 ? 0 : is_box() ? 12 : 1; }
  SIM_FN int count() const { return corners() + edges(); }
  /// Radius of a sphere about the body's centre that contains the body, m. Exact for a sphere, a capsule and
  /// a box; for a mesh an upper bound, the corner of its box.
  SIM_FN float reach() const { return length(body.half) + body.radius; }

  /// Position of corner k in the body's axes, m.
  SIM_FN Vec3 corner(int k) const {
    if (mesh) return mesh->contacts[k];
    const Vec3 h = body.half;
    if (!is_box()) return {0, k ? h.y : -h.y, 0};
    return {k & 1 ? h.x : -h.x, k & 2 ? h.y : -h.y, k & 4 ? h.z : -h.z};
  }
  /// A point on an edge of the box whose half sides are `share` times the body's; s = -1 .. 1 from end to
  /// end.
  SIM_FN Vec3 on_edge(int edge, float s, Vec3 share) const {
    const Vec3 h = scaled(body.half, share);
    if (!is_box()) return {0, s * h.y, 0};
    const float u = edge & 1 ? 1.0f : -1.0f;
    const float v = edge & 2 ? 1.0f : -1.0f;
    if (edge < 4) return {s * h.x, u * h.y, v * h.z};
    if (edge < 8) return {u * h.x, s * h.y, v * h.z};
    return {u * h.x, v * h.y, s * h.z};
  }
  SIM_FN Vec3 in_world(Vec3 own) const { return body.centre + turned(body.turn, own); }

  /// Contact of this body's point k with the body `other`; leaves `ahead`, the smallest gap in the substep,
  /// 0. Near an edge of `other`, rounding changes which part of its surface is nearest to the point.
  /// Therefore `other` is replaced by a plane: the tangent at its surface point nearest to a position
  /// slightly deeper in this body. The gap is the distance of point k from this plane, minus the radius.
  SIM_FN Contact meets(int k, const Solids& solids, int other) const {
    Vec3 own, deeper;
    if (k < corners()) {
      own = corner(k);
      deeper = mesh ? own - mesh->step * mesh->near(own).normal : scaled(own, inset());
    } else {
      const float s = nearest_on_edge(k - corners(), solids, other);
      own = on_edge(k - corners(), s, {1, 1, 1});
      deeper = on_edge(k - corners(), s, inset());
    }
    const Vec3 at = in_world(own);
    const Vec3 from = in_world(deeper);
    const Body::Near near = solids.near(other, from);
    const float gap = near.distance + dot(near.normal, at - from) - body.radius;
    return {at - body.radius * near.normal, near.normal, gap, 0};
  }
  /// Contact of corner k with a wall; leaves `ahead`, the smallest gap in the substep, 0.
  SIM_FN Contact meets(int k, const Walls& walls, int wall) const {
    const Vec3 at = in_world(corner(k));
    const Vec3 normal = walls.planes[wall].normal;
    return {at - body.radius * normal, normal, walls.distance(wall, at) - body.radius, 0};
  }

 private:
  /// Factors that shrink each half side of a box by a twentieth of the shortest; 1 for other shapes.
  SIM_FN Vec3 inset() const {
    if (!is_box()) return {1, 1, 1};
    const Vec3 h = body.half;
    const float way = 0.05f * at_most(at_most(h.x, h.y), h.z);
    return {1 - way / h.x, 1 - way / h.y, 1 - way / h.z};
  }
  SIM_FN static Vec3 scaled(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  /// Parameter s of the point nearest to the body `other` on an edge of the box that inset() shrinks. Found
  /// by golden-section search: along a straight line the distance from a convex body has one minimum.
  SIM_FN float nearest_on_edge(int edge, const Solids& solids, int other) const {
    const Vec3 share = inset();
    constexpr float golden = 0.618034f;
    constexpr int halvings = 16;  ///< steps; they shrink the interval to 1/2200 of the edge
    float low = -1, high = 1;
    float a = high - golden * (high - low), b = low + golden * (high - low);
    float at_a = solids.distance(other, in_world(on_edge(edge, a, share)));
    float at_b = solids.distance(other, in_world(on_edge(edge, b, share)));
    for (int k = 0; k < halvings; ++k) {
      if (at_a <= at_b) {
        high = b;
        b = a;
        at_b = at_a;
        a = high - golden * (high - low);
        at_a = solids.distance(other, in_world(on_edge(edge, a, share)));
      } else {
        low = a;
        a = b;
        at_a = at_b;
        b = low + golden * (high - low);
        at_b = solids.distance(other, in_world(on_edge(edge, b, share)));
      }
    }
    return 0.5f * (low + high);
  }
};

/// Maximum number of contacts per pair of bodies, or per body and wall.
inline constexpr int most_contacts = 4;

/// Selects contacts that together hold two bodies apart, from n contacts. Only contacts count whose `ahead`,
/// the smallest gap expected in the substep, is below `pad` (both in m). The first selected contact is the
/// one with the smallest `ahead`. Each further one is the farthest from the selected ones, and more than pad
/// / 100 away from each. Returns the number of selected contacts, at most most_contacts.
template <class Contacts>
SIM_FN int pick_contacts(const Contacts& all, int n, float pad, Contact* picked) {
  int count = 0;
  while (count < most_contacts) {
    float best = count == 0 ? -pad : 1e-4f * pad * pad;
    int found = -1;
    for (int k = 0; k < n; ++k) {
      const Contact it = all(k);
      if (!(it.ahead < pad)) continue;
      float worth = count == 0 ? -it.ahead : 3e38f;
      for (int j = 0; j < count; ++j) {
        const Vec3 way = it.at - picked[j].at;
        worth = at_most(dot(way, way), worth);
      }
      if (worth <= best) continue;
      best = worth;
      found = k;
    }
    if (found < 0) break;
    picked[count++] = all(found);
  }
  return count;
}

}  // namespace sim::SIM_BACKEND
