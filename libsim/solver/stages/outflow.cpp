#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

void run_outflow(FluidState& state, OutflowView p) {
  const Outflow::Amount left = state.outflow.run(state.particles, p, state.walls, state.heat.data());
  if (left.particles == 0) return;
  state.drained.particles += left.particles;
  state.drained.mass += left.mass;
  state.mass_units -= left.mass;
  // Lists store indices, which have changed.
  state.lists_hold = false;
}

}  // namespace

Stage outflow_stage() {
  return stage_of<run_outflow>({.name = "outflow",
                                .source = "scenes: what is through an outlet leaves",
                                .phase = Phase::FrameEnd,
                                .called_for = [](const Demand& demand) -> std::string {
                                  return demand.outlets && !demand.settling ? "the scene has an outlet" : "";
                                },
                                .changes = Change::Flow});
}

}  // namespace sim::SIM_BACKEND
