#pragma once
/// The temperatures of a scene with the effect `heat`.

#include <array>

namespace sim {

struct Scene;

/// A box whose water has temperature_k at frame 0. Where boxes overlap, the later one counts. Water outside
/// all boxes has the effect's reference temperature.
struct WarmBox {
  std::array<double, 3> min_m{}, max_m{};
  double temperature_k = 0;
};

/// The lowest and highest temperature in a scene; at least 1 K apart, for a colour scale.
struct TemperatureRange {
  double least_k = 0, most_k = 1;
};
TemperatureRange temperatures_of(const Scene& scene);

/// Largest difference between temperatures that the water may have, K: those of boxes, nozzles and walls, and
/// the reference unless one box holds all water and every nozzle has a temperature.
double widest_difference_k(const Scene& scene);
/// Largest product of expansion_per_k and the widest temperature difference, K, that a scene file may have:
/// the buoyancy is then half of the weight. Boussinesq's buoyancy neglects that lighter water has less mass
/// and more volume; at a product of 1 warm water would weigh nothing.
inline constexpr double most_expansion = 0.5;

/// The reference temperature of the effect heat, K; water from a nozzle without a temperature has it.
double reference_temperature(const Scene& scene);
/// True if the scene lists the effect heat.
bool lists_heat(const Scene& scene);

}  // namespace sim
