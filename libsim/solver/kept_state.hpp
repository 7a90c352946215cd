#pragma once
/// The state of a fluid that lasts beyond a frame, for state files.

#include "libsim/solver/stages/fluid_state.hpp"
#include "libsim/solver/state_archive.hpp"

namespace sim::SIM_BACKEND {

template <class Archive>
void keep_jets(Archive& archive, Jets& jets) {
  const std::size_t nozzles = jets.before.size();
  archive(jets.before, jets.level, jets.reservoir, jets.poured, jets.made, jets.taken, jets.waited);
  if constexpr (Archive::reads) {
    if (jets.before.size() != nozzles) Archive::fail("contains a different number of nozzles than the scene");
  }
}

template <class Archive>
void keep_activation(Archive& archive, Activation& a) {
  archive(a.columns_set, a.all_marked, a.grid, a.range, a.slots, a.slot_of);
}

/// Writes or reads the particles in their order, the state that lasts from frame to frame, and the neighbour
/// lists if the next frame starts with them. `state` already has its particle count, columns and walls. State
/// that each frame computes anew is not saved.
template <class Archive>
void keep_fluid(Archive& archive, FluidState& state) {
  archive(state.mass_units, state.drained, state.guards, state.parameters.iterations,
          state.parameters.most_speed, state.lists_hold, state.lists_by_slot);
  keep_columns(archive, state.particles);
  if (state.particles.has(Column::Temperature)) archive(state.heat);
  keep_jets(archive, state.jets);
  archive(state.levels.forced, state.levels.frame, state.levels.turns.frames_since,
          state.levels.turns.in_a_row, state.levels.counts);
  archive(state.saliency.readings.alpha, state.saliency.input, state.saliency.normaliser,
          state.saliency.frames_since);
  keep_activation(archive, state.activation);
  if (state.foam.capacity() > 0) archive(state.foam);
  // Bodies have their positions at the end of the last substep, from which the next frame starts.
  if (state.obstacles.exists()) archive(state.obstacles.bodies);
  if (state.obstacles.free.size() > 0) archive(state.obstacles.free);
  if (state.obstacles.meet()) archive(state.obstacles.by_others);
  // Only stages that set or use target levels read neighbour lists before the particles move, so runs without
  // the column Target do not save the lists.
  const bool with_lists = state.lists_hold && state.particles.has(Column::Target);
  state.neighbours.keep(archive, with_lists);
  if constexpr (Archive::reads) state.lists_hold = with_lists;
}

}  // namespace sim::SIM_BACKEND
