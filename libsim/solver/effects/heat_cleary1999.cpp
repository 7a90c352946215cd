/// Heat: conduction to neighbours and walls, and buoyancy.

#include "libsim/solver/effects/loops/conduction.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A wall of temperature T acts like water behind it, whose temperature continues linearly from the
/// particle's temperature theta through T at the wall. d theta / dt = 2 D (T - theta) / s int z F dV over
/// this water, with the diffusivity D, the particle's distances s to the wall and z to dV's plane parallel to
/// the wall, and F = -(dW/dr) / r. For poly6 the integral is 315 / 256 (1 - q^2)^4 / h with q = s / h. The
/// step is exact for a constant rate, and so stable for any dt.
struct WarmAtWalls {
  const Vec4* position;
  const std::uint8_t* level;
  float* temperature;
  Walls walls;
  HeatLedger* ledger;
  float wall;      ///< temperature of the walls, K above the reference
  float spread;    ///< 2 D dt, m2
  float wall_gap;  ///< minimum distance to a wall, as a share of the particle's spacing
  float widest;    ///< largest support of particles on which the effect acts, m

  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
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

void conduct(FluidState& state, ConductView p) {
  run_pair_loop("conduct heat", state, p, conduction_of(state, p));
  p.swap<Column::Temperature, Column::TemperatureNext>();
}

using WarmView =
    ColumnView<columns(Column::Position, Column::Level, Column::Temperature), columns(Column::Temperature)>;

void warm_at_walls(FluidState& state, WarmView p) {
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
                       .wall_gap = k.wall_gap,
                       .widest = state.widest_support(EffectOption::HeatCoarsest)});
}

struct MassOf {
  const std::uint8_t* level;
  int coarsest;  ///< coarsest level on which the effect acts
  SIM_FN float operator()(int i) const {
    return level[i] > coarsest ? 0.0f : static_cast<float>(1 << level[i]);
  }
};
struct WarmthOf {
  MassOf mass;
  const float* temperature;
  SIM_FN float operator()(int i) const { return mass(i) * temperature[i]; }
};
struct TakeMass {
  MeanWarmth* mean;
  SIM_FN void operator()(float sum) const { mean->mass = sum; }
};
struct TakeWarmth {
  MeanWarmth* mean;
  SIM_FN void operator()(float sum) const { mean->warmth = mean->mass > 0 ? sum / mean->mass : 0; }
};

/// Boussinesq: dv / dt = g beta (theta - mean theta) against gravity, with beta the expansion per kelvin and
/// the mean by mass over the water that takes part in the effect. So a uniform temperature causes no motion,
/// and the buoyancy forces sum to zero.
struct Rise {
  const float* temperature;
  const std::uint8_t* level;
  const MeanWarmth* mean;
  Vec4* velocity;
  Vec3 lift;     ///< g beta dt, against gravity
  int coarsest;  ///< coarsest level on which the effect acts

  SIM_FN void operator()(int i) const {
    if (level[i] > coarsest) return;
    const float warmer = temperature[i] - mean->warmth;
    Vec4& v = velocity[i];
    v.y += warmer * lift.y;
    if (lift.x == 0 && lift.z == 0) return;  // adding 0 would change the sign of -0
    v.x += warmer * lift.x;
    v.z += warmer * lift.z;
  }
};

using RiseView =
    ColumnView<columns(Column::Level, Column::Temperature, Column::Velocity), columns(Column::Velocity)>;

void take_mean(Buoyancy& buoyancy, RiseView p, int capacity, int coarsest) {
  buoyancy.mean.resize(1);
  MeanWarmth* const mean = buoyancy.mean.data();
  const MassOf mass{p.level(), coarsest};
  buoyancy.sum("mass with heat", p.size(), capacity, mass, TakeMass{mean});
  buoyancy.sum("mean warmth", p.size(), capacity, WarmthOf{mass, p.temperature()}, TakeWarmth{mean});
}

void rise(FluidState& state, RiseView p) {
  if (state.parameters.effects[EffectOption::HeatExpansion] == 0) return;
  const auto coarsest = static_cast<int>(state.parameters.effects[EffectOption::HeatCoarsest]);
  take_mean(state.buoyancy, p, state.particles.capacity(), coarsest);
  const auto& k = state.parameters;
  for_each("buoyancy", p.size(),
           Rise{.temperature = p.temperature(),
                .level = p.level(),
                .mean = state.buoyancy.mean.data(),
                .velocity = p.velocity(),
                .lift = k.gravity.strength * k.dt * k.effects[EffectOption::HeatExpansion] * k.gravity.up,
                .coarsest = coarsest});
}

}  // namespace

std::vector<Stage> heat_stages() {
  return {
      stage_of<conduct>({.name = "conduct heat", .phase = Phase::SubstepEnd, .loop = SharedTerm::Conduction}),
      stage_of<warm_at_walls>({.name = "warm at walls", .phase = Phase::SubstepEnd}),
      stage_of<rise>({.name = "buoyancy", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
