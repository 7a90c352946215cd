#include "libsim/render/temperature_scale.hpp"

#include <fmt/core.h>

namespace sim {

TemperatureScale::TemperatureScale(const Scene& scene)
    : heat_(coefficients_of(scene.effects)[EffectKind::Heat] > 0) {
  if (!heat_) return;
  const TemperatureRange range = temperatures_of(scene);
  reference_k_ = reference_temperature(scene);
  least_k_ = range.least_k;
  most_k_ = range.most_k;
}

Overlay TemperatureScale::overlay(std::span<const float> above_k) const {
  Overlay out;
  out.values = above_k;
  out.low = static_cast<float>(least_k_ - reference_k_);
  out.high = static_cast<float>(most_k_ - reference_k_);
  return out;
}

std::string TemperatureScale::words() const {
  return fmt::format("temperature {:.2f} to {:.2f} K", least_k_, most_k_);
}

}  // namespace sim
