#pragma once
/// Heat conduction between neighbours: a term of a loop over them.

#include "libsim/solver/stages/pair_loop.hpp"

namespace sim::SIM_BACKEND {

/// m_i d theta_i / dt = rho_0 sum_j 2 D V_i V_j F_ij (theta_j - theta_i), F = -(dW/dr) / r of poly6, which
/// stays finite if particles overlap. D is the diffusivity. It is the same for all particles, and so equals
/// the published harmonic mean of a pair's values. The term is antisymmetric, so heat is conserved. All
/// particles conduct, including unsolved ones: they have lists too (stages/neighbours.cpp). Walls and air
/// contain no particles, and so insulate. Water coarser than the effect's coarsest level keeps its heat: a
/// pair conducts only if both particles take part.
struct Conduction {
  static constexpr int sums = 1;
  const float* temperature;
  float* next;
  float spread;  ///< 12 D dt, m2: F = 6 poly6 (h^2 - r^2)^2
  float widest;  ///< largest support of particles on which the effect acts, m

  SIM_FN bool takes(float h) const { return h <= widest; }
  using Self = float;  ///< the particle's temperature
  SIM_FN Self self(int i) const { return temperature[i]; }
  SIM_FN void add(const NeighbourPair& pair, Self own, float& gain, float&, float&, float&) const {
    const float slope = pair.h <= widest ? pair.slope : 0.0f;
    gain += slope * (temperature[pair.j] - own);
  }
  SIM_FN void finish(int i, Vec4 at, Self own, float gain, float, float, float) const {
    next[i] = own + spread * mass_of(at.w, 1) * gain;
  }
  SIM_FN void skip(int i) const { next[i] = temperature[i]; }
};

using ConductView = ColumnView<columns(Column::Position, Column::Neighbours),
                               columns(Column::Temperature, Column::TemperatureNext)>;

/// The term for run_pair_loop. It writes TemperatureNext; swap the two columns afterwards.
inline Conduction conduction_of(const FluidState& state, ConductView p) {
  const auto& k = state.parameters;
  return {.temperature = p.temperature(),
          .next = p.temperature_next(),
          .spread = 12 * k.dt * k.effects[EffectKind::Heat],
          .widest = state.widest_support(EffectOption::HeatCoarsest)};
}

}  // namespace sim::SIM_BACKEND
