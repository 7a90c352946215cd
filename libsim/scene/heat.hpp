#pragma once
/// What a scene with the effect `heat` says of temperatures.

#include <array>

namespace sim {

struct Scene;

/// A box whose water is warm, or cold, when frame 0 begins. Where boxes overlap the later one counts. Water
/// in no box has the effect's reference temperature.
struct WarmBox {
  std::array<double, 3> min_m{}, max_m{};
  double temperature_k = 0;
};

/// The coldest and the hottest that a scene names; 1 K apart at least, for a scale of colours.
struct TemperatureRange {
  double least_k = 0, most_k = 1;
};
TemperatureRange temperatures_of(const Scene& scene);

/// What water poured by a nozzle without a temperature has, K: the reference.
double reference_temperature(const Scene& scene);
/// Is the effect listed?
bool lists_heat(const Scene& scene);

}  // namespace sim
