#include "libsim/levels/split_merge.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

void run_split_and_merge(FluidState& state, LevelView p) {
  if (!state.levels.turns.due) return grow_older(state.levels, p);
  const LevelFluid fluid{.particles = p,
                         .neighbours = state.particle_neighbours(),
                         .last_active = state.last_active(),
                         .solids = state.solids(),
                         .supports = state.supports,
                         .rest_density = state.parameters.rest_density,
                         .wall_gap = state.parameters.wall_gap};
  split_and_merge(state.levels, fluid, state.particles);
  if (state.levels.changed) state.lists_hold = false;
}

}  // namespace

Stage split_and_merge_stage() {
  return stage_of<run_split_and_merge>({.name = "split and merge",
                                        .source = "Algorithms 1 and 2",
                                        .phase = Phase::FrameStart,
                                        .called_for = if_levels,
                                        .part = Part::Levels,
                                        .changes = Change::Levels});
}

}  // namespace sim::SIM_BACKEND
