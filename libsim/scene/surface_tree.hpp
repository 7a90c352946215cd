#pragma once
/// Exact distance from a closed surface of triangles.

#include <array>
#include <vector>

#include "libsim/scene/obj_text.hpp"

namespace sim {

/// A tree of boxes over the triangles. The sign is that of the pseudonormal of the nearest face, edge or
/// corner, where normals count by their angles (Baerentzen and Aanaes 2005).
class SurfaceTree {
 public:
  explicit SurfaceTree(const Triangles& mesh);
  /// Signed, negative inside, in the mesh's unit. `at_most`: a bound that the distance is known to keep; a
  /// smaller one is quicker.
  double distance(const std::array<double, 3>& point, double at_most = 1e30) const;

 private:
  using Vector = std::array<double, 3>;
  struct Node {
    Vector low, high;
    int first = 0, count = 0;  ///< of triangles; none: two nodes follow
    int second = 0;            ///< the other follows at once
  };
  struct Triangle {
    std::array<Vector, 3> corners;
    Vector face;                 ///< its normal, a unit vector
    std::array<Vector, 3> edge;  ///< pseudonormals from corner k to k + 1
    std::array<Vector, 3> corner;
  };
  int build(int first, int count);
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace sim
