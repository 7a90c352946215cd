#include "libsim/scene/central_force.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/scene/vector.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

std::optional<CentralForce> read_central_force(const base::TomlTable& scene,
                                               const std::array<double, 3>& origin_m) {
  if (!scene.has("central_force")) return {};
  const auto table = scene.table("central_force");
  CentralForce out;
  out.omega_per_s = table.number("omega_per_s", {1e-3, 1e3});
  const auto [least, most] = std::minmax_element(origin_m.begin(), origin_m.end());
  const auto centre = table.numbers("centre_m", 3, {*least - farthest_m, *most + farthest_m});
  const auto axis = table.numbers("axis", 3, {-1e3, 1e3});
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  if (!(length >= 1e-3)) {
    table.fail("axis", "has no direction: its length is " + base::shortest(length) + ", less than 0.001",
               "use a longer vector, such as [0.0, 0.0, 1.0]");
  }
  for (std::size_t k = 0; k < 3; ++k) {
    out.centre_m[k] = centre[k] - origin_m[k];
    out.axis[k] = axis[k] / length;
  }
  return out;
}

double distance_from_axis(const CentralForce& force, const std::array<double, 3>& point_m) {
  double along = 0;
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double offset = point_m[k] - force.centre_m[k];
    along += offset * force.axis[k];
    squared += offset * offset;
  }
  return std::sqrt(std::fmax(squared - along * along, 0));
}

}  // namespace sim
