#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

SaliencyFluid fluid_of(FluidState& state, Reads<Column::Position> p, float* saliency, std::uint8_t* target) {
  return {.position = p.position(),
          .n = p.size(),
          .finest_support = state.finest_support,
          .saliency = saliency,
          .target = target,
          .guards = state.guard()};
}

using GazeTargetsColumns = ColumnView<columns(Column::Position), columns(Column::Saliency, Column::Target)>;

void run_gaze_targets(FluidState& state, GazeTargetsColumns p) {
  if (!state.levels.turns.due) return;
  evaluate_gaze(state.saliency, fluid_of(state, p, p.saliency(), p.target()));
}

}  // namespace

void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target) {
  const auto size = static_cast<std::size_t>(state.particles.size());
  saliency.resize(size);
  target.resize(size);
  const Reads<Column::Position> p(state.particles);
  observer.look_around(state.parameters.frame_s());
  evaluate_gaze(observer, fluid_of(state, p, saliency.data(), target.data()));
}

Stage gaze_targets_stage() {
  return stage_of<run_gaze_targets>({.name = "gaze targets",
                                     .source = "FovFluid-like: fovea, band, periphery",
                                     .phase = Phase::FrameStart,
                                     .called_for = [](const Demand& demand) -> std::string {
                                       return demand.gaze_targets ? "levels follow the gaze" : "";
                                     },
                                     .part = Part::Saliency});
}

}  // namespace sim::SIM_BACKEND
