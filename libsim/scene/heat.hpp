#pragma once
/// The temperatures of a scene with the effect `heat`.

#include <array>

namespace sim {

struct Scene;

/// A box whose water is warm, or cold, at frame 0. Where boxes overlap, the later one counts. Water outside
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
/// Largest expansion times kelvin that a scene file may name: half of the water's weight. Boussinesq's
/// buoyancy leaves out that lighter water has less mass and more volume; at 1 warm water weighs nothing.
inline constexpr double most_expansion = 0.5;

/// Temperature of water from a nozzle without one, K: the reference.
double reference_temperature(const Scene& scene);
/// True if the scene lists the effect.
bool lists_heat(const Scene& scene);

}  // namespace sim
