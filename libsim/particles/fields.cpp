#include <cmath>

#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

std::vector<float> field_of(const Particles& particles, ParticleField field) {
  const auto n = static_cast<std::size_t>(particles.size());
  std::vector<float> out(n, field == ParticleField::Active ? 1.0f : 0.0f);
  if (field == ParticleField::Speed) {
    const auto velocity = particles.velocity.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = length(xyz(velocity[i]));
  } else if (field == ParticleField::DensityError && particles.has(Column::Density)) {
    const auto density = particles.density.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = density[i] - 1;
  } else if (field == ParticleField::Active && particles.has(Column::Active)) {
    const auto active = particles.active.to_host();
    for (std::size_t i = 0; i < n; ++i) out[i] = active[i];
  }
  return out;
}

}  // namespace sim::SIM_BACKEND
