#pragma once
/// A force towards an axis, in addition to gravity.

#include <array>
#include <optional>

namespace base {
class TomlTable;
}

namespace sim {

/// Acceleration -Omega^2 r, where r is the vector from the nearest point of the axis to the particle. In a
/// slab between two walls perpendicular to the axis the water forms a two-dimensional drop (Monaghan and
/// Rafiee 2013).
struct CentralForce {
  double omega_per_s = 0;               ///< Omega: a lone particle oscillates with the period 2 pi / Omega
  std::array<double, 3> centre_m{};     ///< a point of the axis
  std::array<double, 3> axis{0, 0, 1};  ///< direction of the axis, a unit vector
};

/// The table [central_force] of a scene file; none if absent. base::Error, for example if a key is missing, a
/// value is out of range or the axis has no direction. origin_m: Scene::origin_m, subtracted from the centre.
std::optional<CentralForce> read_central_force(const base::TomlTable& scene,
                                               const std::array<double, 3>& origin_m);

/// Distance from the axis, m.
double distance_from_axis(const CentralForce& force, const std::array<double, 3>& point_m);

}  // namespace sim
