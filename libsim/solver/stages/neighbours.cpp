/// The stages that sort the particles into the grid and list their neighbours.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

void sort(FluidState& state) {
  if (state.one_level) {
    state.grid.build(state.particles, NeighbourList::margin, state.domain, state.lightest_support);
  } else {
    state.grid.build(state.particles, NeighbourList::margin, state.domain, state.supports);
  }
}

using SubstepView = ColumnView<NeighboursView::reads, NeighboursView::writes, columns(Column::Active),
                               columns(Column::Lambda, Column::Density, Column::PredictedNext)>;

/// Lists neighbours in a substep that does not solve all particles. Only solved particles need lists, unless
/// the next frame's level update reads the lists.
void list_active(FluidState& state, SubstepView p) {
  const Witness witness = state.witness(p.id(), 0);
  sort(state);
  state.lists_by_slot = true;
  state.lists_hold = false;
  state.activation.list_active(p);
  const bool hold = !state.one_level && state.substep + 1 == state.parameters.substeps;
  if (hold) {
    state.neighbours.build(p, state.grid, EverySlot{state.activation.slots.data()}, witness);
    state.lists_hold = hold;
  } else {
    state.neighbours.build(p, state.grid, state.active(), witness);
  }
}

void run_substep(FluidState& state, SubstepView p) {
  state.all_active ? find_neighbours(state, p) : list_active(state, p);
}

using PresentView = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                               columns(Column::Predicted, Column::Neighbours), columns(Column::Active),
                               columns(Column::Lambda, Column::Density, Column::PredictedNext)>;

/// Lists the neighbours at the positions before the move, in a frame's first substep. Later substeps use the
/// lists of the substep before, whose margin covers the moves since then. Each frame searches anew, so that
/// its lists depend on the particles alone.
void run_present(FluidState& state, PresentView p) {
  if (state.substep > 0) return;
  p.copy<Column::Predicted, Column::Position>();
  run_substep(state, p);
}

using FrameView = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                             columns(Column::Predicted, Column::Neighbours)>;

void run_frame_start(FluidState& state, FrameView p) {
  if (state.lists_hold) return;
  p.copy<Column::Predicted, Column::Position>();
  find_neighbours(state, p);
}

}  // namespace

void find_neighbours(FluidState& state, NeighboursView p) {
  const Witness witness = state.witness(p.id(), 0);
  sort(state);
  state.lists_by_slot = false;
  state.lists_hold = true;
  state.neighbours.build(p, state.grid, witness);
}

Stage neighbours_stage() {
  return stage_of<run_substep>(
      {.name = "neighbours",
       .source = "compact grid and one combined list a substep",
       .phase = Phase::Substep,
       .called_for = [](const Demand&) -> std::string { return "the density constraint needs neighbours"; }});
}

Stage present_neighbours_stage() {
  return stage_of<run_present>({.name = "present neighbours",
                                .source = "the same at the positions that the forces found",
                                .phase = Phase::Substep,
                                .called_for = if_thick});
}

Stage frame_neighbours_stage() {
  return stage_of<run_frame_start>({.name = "frame neighbours",
                                    .source = "neighbour list at the frame's start",
                                    .phase = Phase::FrameStart,
                                    .called_for = [](const Demand& demand) -> std::string {
                                      // The stage saliency finds the neighbours itself.
                                      return demand.levels && !demand.saliency ? "levels compare neighbours"
                                                                               : "";
                                    },
                                    .part = Part::Levels});
}

}  // namespace sim::SIM_BACKEND
