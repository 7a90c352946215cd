#include "libsim/scene/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "libsim/scene/vector.hpp"

namespace sim {

namespace {

constexpr int leaf_size = 4;
constexpr int deepest = 64;

Vector unit(const Vector& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
double angle(const Vector& a, const Vector& b) {
  return std::acos(std::clamp(dot(unit(a), unit(b)), -1.0, 1.0));
}

/// Squared distance from a box.
double away2(const Vector& low, const Vector& high, const Vector& p) {
  double out = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beyond = std::max({low[k] - p[k], p[k] - high[k], 0.0});
    out += beyond * beyond;
  }
  return out;
}

/// The nearest point of a triangle, and the edge or corner that contains it.
struct Nearest {
  Vector at;
  int edge = -1, corner = -1;  ///< both -1: inside the face
};
Nearest nearest_on_edge(const std::array<Vector, 3>& corners, int k, const Vector& p) {
  const auto from = static_cast<std::size_t>(k), to = static_cast<std::size_t>((k + 1) % 3);
  const Vector along = minus(corners[to], corners[from]);
  const double share = dot(minus(p, corners[from]), along) / dot(along, along);
  if (share <= 0) return {corners[from], -1, k};
  if (share >= 1) return {corners[to], -1, (k + 1) % 3};
  return {sum(corners[from], share, along), k, -1};
}
Nearest nearest_on(const std::array<Vector, 3>& corners, const Vector& face, const Vector& p) {
  bool inside = true;
  for (std::size_t k = 0; k < 3 && inside; ++k)
    inside = dot(cross(minus(corners[(k + 1) % 3], corners[k]), minus(p, corners[k])), face) > 0;
  if (inside) return {sum(p, -dot(minus(p, corners[0]), face), face)};
  Nearest out;
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Nearest here = nearest_on_edge(corners, k, p);
    const Vector way = minus(p, here.at);
    if (dot(way, way) >= least) continue;
    least = dot(way, way);
    out = here;
  }
  return out;
}

}  // namespace

SurfaceTree::SurfaceTree(const Triangles& mesh) {
  std::vector<Vector> at_place(mesh.places.size(), Vector{});
  std::map<std::array<int, 2>, Vector> at_edge;
  const auto key = [](int a, int b) { return std::array<int, 2>{std::min(a, b), std::max(a, b)}; };
  for (const auto& face : mesh.faces) {
    Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) t.corners[k] = mesh.places[static_cast<std::size_t>(face[k])];
    t.face = unit(cross(minus(t.corners[1], t.corners[0]), minus(t.corners[2], t.corners[0])));
    for (std::size_t k = 0; k < 3; ++k) {
      Vector& corner = at_place[static_cast<std::size_t>(face[k])];
      const Vector to = minus(t.corners[(k + 1) % 3], t.corners[k]);
      corner = sum(corner, angle(to, minus(t.corners[(k + 2) % 3], t.corners[k])), t.face);
      Vector& edge = at_edge[key(face[k], face[(k + 1) % 3])];
      edge = sum(edge, 1, t.face);
    }
    triangles_.push_back(t);
  }
  for (std::size_t f = 0; f < triangles_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = mesh.faces[f][k];
      triangles_[f].corner[k] = at_place[static_cast<std::size_t>(from)];
      triangles_[f].edge[k] = at_edge[key(from, mesh.faces[f][(k + 1) % 3])];
    }
  }
  build(0, static_cast<int>(triangles_.size()));
}

int SurfaceTree::build(int first, int count) {
  const auto own = static_cast<int>(nodes_.size());
  Node node{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, first, count};
  for (int k = first; k < first + count; ++k) {
    for (const Vector& corner : triangles_[static_cast<std::size_t>(k)].corners) {
      for (std::size_t a = 0; a < 3; ++a) {
        node.low[a] = std::min(node.low[a], corner[a]);
        node.high[a] = std::max(node.high[a], corner[a]);
      }
    }
  }
  nodes_.push_back(node);
  if (count <= leaf_size) return own;
  const Vector size = minus(node.high, node.low);
  const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const auto middle = [axis](const Triangle& t) {
    return t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis];
  };
  const auto begin = triangles_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
  build(first, count / 2);
  const int second = build(first + count / 2, count - count / 2);
  nodes_[static_cast<std::size_t>(own)].count = 0;
  nodes_[static_cast<std::size_t>(own)].second = second;
  return own;
}

double SurfaceTree::distance(const Vector& point, double at_most) const {
  double least2 = at_most * at_most;
  double side = 1;
  std::array<int, deepest> waiting{};
  std::size_t count = 1;
  while (count > 0) {
    const int own = waiting[--count];
    const Node& node = nodes_[static_cast<std::size_t>(own)];
    if (away2(node.low, node.high, point) > least2) continue;
    if (node.count == 0) {
      const Node& first = nodes_[static_cast<std::size_t>(own + 1)];
      const Node& second = nodes_[static_cast<std::size_t>(node.second)];
      const bool first_nearer = away2(first.low, first.high, point) <= away2(second.low, second.high, point);
      waiting[count++] = first_nearer ? node.second : own + 1;
      waiting[count++] = first_nearer ? own + 1 : node.second;
    }
    for (int k = node.first; k < node.first + node.count; ++k) {
      const Triangle& t = triangles_[static_cast<std::size_t>(k)];
      const Nearest nearest = nearest_on(t.corners, t.face, point);
      const Vector way = minus(point, nearest.at);
      const double here2 = dot(way, way);
      if (here2 > least2) continue;
      least2 = here2;
      const Vector& normal = nearest.corner >= 0 ? t.corner[static_cast<std::size_t>(nearest.corner)]
                             : nearest.edge >= 0 ? t.edge[static_cast<std::size_t>(nearest.edge)]
                                                 : t.face;
      side = dot(way, normal) < 0 ? -1 : 1;
    }
  }
  return side * std::sqrt(least2);
}

}  // namespace sim
