#pragma once
/// Exact distance from a closed surface of triangles.

#include <array>
#include <vector>

#include "libsim/scene/obj_text.hpp"

namespace sim {

/// A tree of boxes over the triangles. The sign comes from the pseudonormal of the nearest face, edge or
/// corner, with normals weighted by their angles (Baerentzen and Aanaes 2005).
class SurfaceTree {
 public:
  explicit SurfaceTree(const Triangles& mesh);
  /// Signed, negative inside, in the mesh's unit. `at_most`: a known upper bound of the distance; a smaller
  /// bound is faster.
  double distance(const std::array<double, 3>& point, double at_most = 1e30) const;

 private:
  using Vector = std::array<double, 3>;
  struct Node {
    Vector low, high;
    int first = 0, count = 0;  ///< triangles of a leaf; count 0: an inner node with two children
    int second = 0;            ///< index of the second child; the first child is the next node
  };
  struct Triangle {
    std::array<Vector, 3> corners;
    Vector face;                   ///< unit normal
    std::array<Vector, 3> edge;    ///< pseudonormals of the edges from corner k to k + 1
    std::array<Vector, 3> corner;  ///< pseudonormals of the corners
  };
  int build(int first, int count);
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace sim
