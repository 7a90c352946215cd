/// Heat: warm water warms what touches it, and rises.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// m_i d theta_i / dt = rho_0 sum_j 2 D V_i V_j F_ij (theta_j - theta_i), F = -(dW/dr) / r of poly6, which
/// stays finite where particles overlap; the harmonic mean of two equal conductivities is D. Antisymmetric,
/// so that the heat stays. Everyone conducts, also those that are not solved: they have lists too
/// (stages/neighbours.cpp). What has no neighbours, a wall or the air, insulates.
template <bool OneLevel, class Selection>
struct Conduct {
  Selection select;
  const Vec4* position;
  const float* temperature;
  Neighbours neighbours;
  float* next;
  float spread;  ///< 12 D dt, m2: F = 6 poly6 (h^2 - r^2)^2

  /// What particle j adds, over V_i; see SIM_LANES.
  SIM_FN void add(int j, Vec4 self, float own, const PairKernel<OneLevel>& pair, float& gain) const {
    const Vec4 other = position[j];
    const Kernel kernel = pair.with(other.w);
    const float dx = self.x - other.x;
    const float dy = self.y - other.y;
    const float dz = self.z - other.z;
    const float t = at_least(kernel.h2 - (dx * dx + dy * dy + dz * dz), 0.0f);
    gain += pair.mass_ratio(other.w) * kernel.poly6 * t * t * (temperature[j] - own);
  }

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    const Vec4 self = position[i];
    const float own = temperature[i];
    const PairKernel<OneLevel> pair(self.w);
    float gain = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    SIM_LANES(gain)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], self, own, pair, gain);
    gain = team.sum(gain);
    if (team.rank() == 0) next[i] = own + spread * mass_of(self.w, 1) * gain;
  }
};

/// A wall of the temperature T stands for water whose temperature goes on along the line from the particle's
/// through T at the wall: d theta / dt = 2 D (T - theta) / s int z F over the water behind it, which is
/// 315 / 256 (1 - q^2)^4 / h for poly6, with q = s / h. Exact for a constant rate, so that no step is too
/// long.
struct WarmAtWalls {
  const Vec4* position;
  const std::uint8_t* level;
  float* temperature;
  Walls walls;
  HeatLedger* ledger;
  float wall;      ///< K above the reference
  float spread;    ///< 2 D dt, m2
  float wall_gap;  ///< nearest distance to a wall, as a share of d

  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    float steps = 0;
    for (int k = 0; k < walls.count; ++k) {
      const float q = at_least(walls.distance_in_h(k, xyz(at), at.w), 0.5f * wall_gap);
      if (q >= 1 || walls.absent(k, xyz(at))) continue;
      const float u = 1 - q * q;
      steps += 315.0f / 256 * spread * u * u * u * u / (at.w * at.w * q);
    }
    if (steps == 0) return;
    const float before = temperature[i];
    const float after = before + (1 - expf(-steps)) * (wall - before);
    temperature[i] = after;
    atomic_add(&ledger->walls, HeatLedger::of(after - before, level[i]));
  }
};

using ConductView = ColumnView<columns(Column::Position, Column::Level, Column::Neighbours),
                               columns(Column::Temperature, Column::TemperatureNext)>;

template <bool OneLevel, class Selection>
void launch(FluidState& state, ConductView p, Selection select) {
  const auto& k = state.parameters;
  for_each_team("conduct heat", p.size(),
                Conduct<OneLevel, Selection>{.select = select,
                                             .position = p.position(),
                                             .temperature = p.temperature(),
                                             .neighbours = state.neighbours.view(),
                                             .next = p.temperature_next(),
                                             .spread = 12 * k.dt * k.effects[EffectKind::Heat]});
}

template <class Selection>
void launch(FluidState& state, ConductView p, Selection select) {
  state.one_level ? launch<true>(state, p, select) : launch<false>(state, p, select);
}

void warm_at_walls(FluidState& state, ConductView p) {
  const auto& k = state.parameters;
  const float wall = k.effects[EffectOption::HeatWall];
  if (wall == 0) return;
  for_each("warm at walls", p.size(),
           WarmAtWalls{.position = p.position(),
                       .level = p.level(),
                       .temperature = p.temperature(),
                       .walls = state.walls,
                       .ledger = state.heat.data(),
                       .wall = wall - k.effects[EffectOption::HeatReference],
                       .spread = 2 * k.dt * k.effects[EffectKind::Heat],
                       .wall_gap = k.wall_gap});
}

void conduct(FluidState& state, ConductView p) {
  state.all_active ? launch(state, p, AllParticles{})
                   : launch(state, p, EverySlot{state.activation.slots.data()});
  p.swap<Column::Temperature, Column::TemperatureNext>();
  warm_at_walls(state, p);
}

/// Boussinesq: dv / dt = g beta theta upwards, with beta the expansion per kelvin. It acts on those on whom
/// gravity acts.
template <class Selection>
struct Rise {
  Selection select;
  const float* temperature;
  Vec4* velocity;
  float lift;  ///< g beta dt

  SIM_FN void operator()(int i) const {
    float dv = lift * temperature[i];
    if constexpr (!Selection::everyone) dv *= select.falls(i);
    velocity[i].y += dv;
  }
};

using RiseView = ColumnView<columns(Column::Temperature, Column::Velocity), columns(Column::Velocity)>;

template <class Selection>
void launch(FluidState& state, RiseView p, Selection select) {
  const auto& k = state.parameters;
  for_each("buoyancy", p.size(),
           Rise<Selection>{.select = select,
                           .temperature = p.temperature(),
                           .velocity = p.velocity(),
                           .lift = k.gravity * k.dt * k.effects[EffectOption::HeatExpansion]});
}

void rise(FluidState& state, RiseView p) {
  if (state.parameters.effects[EffectOption::HeatExpansion] == 0) return;
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

}  // namespace

std::vector<Stage> heat_stages() {
  return {stage_of<conduct>({.name = "heat", .phase = Phase::SubstepEnd}),
          stage_of<rise>({.name = "buoyancy", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
