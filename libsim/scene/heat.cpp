#include "libsim/scene/heat.hpp"

#include <algorithm>

#include "libsim/scene/scene.hpp"

namespace sim {

bool lists_heat(const Scene& scene) {
  return std::any_of(scene.effects.begin(), scene.effects.end(),
                     [](const Effect& effect) { return effect.kind == EffectKind::Heat; });
}

double reference_temperature(const Scene& scene) {
  const auto options = coefficients_of(scene.effects).options;
  return options[static_cast<std::size_t>(EffectOption::HeatReference)];
}

TemperatureRange temperatures_of(const Scene& scene) {
  const double reference = reference_temperature(scene);
  TemperatureRange out{reference, reference};
  const auto include = [&](double kelvin) {
    if (kelvin == 0) return;
    out.least_k = std::min(out.least_k, kelvin);
    out.most_k = std::max(out.most_k, kelvin);
  };
  include(coefficients_of(scene.effects).options[static_cast<std::size_t>(EffectOption::HeatWall)]);
  for (const Nozzle& nozzle : scene.nozzles) include(nozzle.temperature_k);
  for (const WarmBox& box : scene.warm) include(box.temperature_k);
  out.most_k = std::max(out.most_k, out.least_k + 1);
  return out;
}

}  // namespace sim
