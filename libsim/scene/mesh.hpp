#pragma once
/// A mesh as a rigid body: its mass distribution, and its signed distance on a grid.

#include <array>
#include <mutex>
#include <string>
#include <vector>

#include "libsim/scene/obj_text.hpp"
#include "libsim/scene/surface_tree.hpp"

namespace sim {

/// Signed distances at the nodes of a grid around the surface, x fastest.
struct DistanceGrid {
  std::array<double, 3> low_m{};
  double step_m = 0;
  std::array<int, 3> nodes{};
  std::vector<float> values_m;
};

/// Volume, centre of mass and moments of the solid enclosed by a surface, for uniform density: sums over the
/// tetrahedra that one point forms with each triangle.
struct MassProperties {
  double volume_m3 = 0;
  std::array<double, 3> centre_m{};
  /// Inertia tensor about the centre divided by the mass, m2.
  std::array<std::array<double, 3>, 3> inertia_m2{};
};
MassProperties mass_properties(const Triangles& mesh);

inline constexpr std::size_t most_grid_nodes = 1 << 21;

/// A closed surface with its mass properties and signed distances, in the body's axes: the principal axes
/// through the centre of mass, parallel to the file's axes if those are principal.
class Mesh {
 public:
  /// spacing_m: distance of the grid's nodes, so large that the grid has at most most_grid_nodes nodes
  /// (unchecked); 0 = the smaller of a 48th of the longest side and a quarter of the shortest.
  Mesh(const Triangles& mesh, double spacing_m);

  const std::vector<std::array<double, 3>>& places_m() const { return mesh_.places; }
  double volume_m3() const { return volume_m3_; }
  const std::array<double, 3>& inertia_m2() const { return inertia_m2_; }
  /// Unit quaternion x, y, z, w from the body's axes to the file's.
  const std::array<double, 4>& turn() const { return turn_; }
  /// True for each of the body's axes k about which it is round, apart from facets: over the surface, the
  /// mean of (r x n)_k^2 is at most 1 % of the mean squared distance from the axis, with the position r and
  /// the unit normal n.
  const std::array<bool, 3>& round_about() const { return round_about_; }
  /// Bounding box along the body's axes.
  const std::array<double, 3>& low_m() const { return low_m_; }
  const std::array<double, 3>& high_m() const { return high_m_; }
  double farthest_m() const { return farthest_m_; }  ///< distance of the farthest point from the centre
  double spacing_m() const { return spacing_m_; }
  double grid_nodes() const;  ///< number of nodes
  /// Exact signed distance in the body's axes.
  double distance_m(const std::array<double, 3>& at_m) const { return tree_.distance(at_m); }
  /// Computed on first use. Bit-identical for any number of threads.
  const DistanceGrid& grid() const;
  /// Surface points for contacts with walls: the farthest ones in some 70 directions.
  std::vector<std::array<double, 3>> contacts_m() const;
  /// Twice the depth of the deepest node of grid(), m.
  double thickness_m() const;
  /// SHA-256 of the triangles and the given spacing.
  const std::string& sha256() const { return sha256_; }

 private:
  double nodes_along(std::size_t axis) const;
  Triangles mesh_;
  double volume_m3_ = 0;
  std::array<double, 3> inertia_m2_{}, low_m_{}, high_m_{};
  std::array<double, 4> turn_{0, 0, 0, 1};
  std::array<bool, 3> round_about_{};
  double farthest_m_ = 0, spacing_m_ = 0;
  std::string sha256_;
  SurfaceTree tree_;
  mutable std::once_flag baked_;
  mutable DistanceGrid grid_;
};

}  // namespace sim
