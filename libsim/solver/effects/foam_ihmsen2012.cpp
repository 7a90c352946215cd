/// Spray, foam and bubbles, computed once per frame: the water moves them, but they do not act on the water.

#include "libsim/foam/motion.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

FoamRules rules_of(const FluidState& state) {
  const auto& k = state.parameters;
  const auto& e = k.effects;
  const float diameter = e[EffectOption::FoamDiameter];
  const auto coarsest = static_cast<int>(e[EffectOption::FoamCoarsest]);
  return {.dt = k.dt * static_cast<float>(k.substeps),
          .gravity = k.gravity,
          .rate = e[EffectKind::Foam],
          .approach = {e[EffectOption::FoamApproachFrom], e[EffectOption::FoamApproachSpan]},
          .crest = {e[EffectOption::FoamCrestFrom], e[EffectOption::FoamCrestSpan]},
          .crest_depth = e[EffectOption::FoamCrestWeight] * state.foam.cells.grid.frame.edge,
          .energy = {e[EffectOption::FoamEnergyFrom], e[EffectOption::FoamEnergySpan]},
          .coarsest = coarsest,
          // Coarsest level beside emitting water: with graded targets, neighbours differ by at most one
          // level.
          .coarsest_seen = state.levels.rules.graded ? coarsest + 1 : most_levels - 1,
          .lifetime = e[EffectOption::FoamLifetime],
          .volume = pi / 6 * diameter * diameter * diameter,
          .air_drag = e[EffectOption::FoamAirDrag],
          .rise = e[EffectOption::FoamRise]};
}

template <class Bounds>
void foam(FluidState& state, FoamView p, const Bounds& bounds) {
  FoamPool& pool = state.foam;
  const FoamRules rules = rules_of(state);
  if (p.size() > 0) {
    pool.approach.resize(static_cast<std::size_t>(p.size()));
    find_meeting(pool.cells, p, bounds);
    find_foam_surface(pool, p, state.grid, bounds, rules);
    count_foam_births(pool, p, state.grid, rules);
    emit_foam(pool, p, bounds, rules);
  }
  move_foam(pool, p, state.grid, bounds, rules);
  ++pool.frame;
}

void run_foam(FluidState& state, FoamView p) {
  state.obstacles.exists() ? foam(state, p, state.solids()) : foam(state, p, state.walls);
}

}  // namespace

std::vector<Stage> foam_stages() { return {stage_of<run_foam>({.name = "foam", .phase = Phase::FrameEnd})}; }

}  // namespace sim::SIM_BACKEND
