#include "libsim/scene/heat.hpp"

#include <algorithm>

#include "libsim/scene/scene.hpp"

namespace sim {

bool lists_heat(const Scene& scene) {
  return std::any_of(scene.effects.begin(), scene.effects.end(),
                     [](const Effect& effect) { return effect.kind == EffectKind::Heat; });
}

namespace {

double option_of(const Scene& scene, EffectOption option) {
  return coefficients_of(scene.effects).options[static_cast<std::size_t>(option)];
}

void include(TemperatureRange& range, double kelvin) {
  range.least_k = std::min(range.least_k, kelvin);
  range.most_k = std::max(range.most_k, kelvin);
}

bool holds_all_water(const WarmBox& box, const Scene& scene) {
  return std::all_of(scene.water.begin(), scene.water.end(), [&](const WaterBlock& block) {
    for (std::size_t k = 0; k < 3; ++k)
      if (box.min_m[k] > block.min_m[k] || box.max_m[k] < block.max_m[k]) return false;
    return true;
  });
}

}  // namespace

double reference_temperature(const Scene& scene) { return option_of(scene, EffectOption::HeatReference); }

TemperatureRange temperatures_of(const Scene& scene) {
  const double reference = reference_temperature(scene);
  TemperatureRange out{reference, reference};
  if (const double wall = option_of(scene, EffectOption::HeatWall); wall > 0) include(out, wall);
  for (const Nozzle& nozzle : scene.nozzles)
    if (nozzle.temperature_k > 0) include(out, nozzle.temperature_k);
  for (const WarmBox& box : scene.warm) include(out, box.temperature_k);
  out.most_k = std::max(out.most_k, out.least_k + 1);
  return out;
}

double widest_difference_k(const Scene& scene) {
  // A later box replaces the temperature of an earlier one. Boxes before one that holds all water have no
  // effect.
  const auto last = std::find_if(scene.warm.rbegin(), scene.warm.rend(),
                                 [&](const WarmBox& box) { return holds_all_water(box, scene); });
  const bool covered = last != scene.warm.rend();
  const auto first = covered ? last.base() - 1 : scene.warm.begin();
  const double start = covered ? first->temperature_k : reference_temperature(scene);
  TemperatureRange out{start, start};
  for (auto box = first; box != scene.warm.end(); ++box) include(out, box->temperature_k);
  for (const Nozzle& nozzle : scene.nozzles)
    include(out, nozzle.temperature_k > 0 ? nozzle.temperature_k : reference_temperature(scene));
  if (const double wall = option_of(scene, EffectOption::HeatWall); wall > 0) include(out, wall);
  return out.most_k - out.least_k;
}

}  // namespace sim
