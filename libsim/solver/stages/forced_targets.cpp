#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Force {
  const Vec4* position;
  std::uint8_t* target;
  TargetSphere sphere;
  int coarsest;
  SIM_FN void operator()(int i) const {
    const Vec3 offset = xyz(position[i]) - sphere.centre;
    const bool inside = dot(offset, offset) <= sphere.radius * sphere.radius;
    const int wish = inside ? sphere.inside : sphere.outside;
    target[i] = static_cast<std::uint8_t>(wish < coarsest ? wish : coarsest);
  }
};

using ForcedTargetsColumns = ColumnView<columns(Column::Position), columns(Column::Target)>;

void run_forced_targets(FluidState& state, ForcedTargetsColumns p) {
  for_each("force targets", p.size(),
           Force{p.position(), p.target(), state.levels.forced, state.levels.rules.coarsest});
}

}  // namespace

Stage forced_targets_stage() {
  return stage_of<run_forced_targets>({.name = "forced targets",
                                       .source = "a test's levels",
                                       .phase = Phase::FrameStart,
                                       .called_for = [](const Demand& demand) -> std::string {
                                         return demand.forced_targets ? "a test gives them" : "";
                                       },
                                       .part = Part::Levels});
}

}  // namespace sim::SIM_BACKEND
