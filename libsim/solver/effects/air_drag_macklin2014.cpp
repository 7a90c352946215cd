/// Air drag: air at rest brakes exposed water.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// v decreases at the rate k e_i, with k the effect's coefficient, 1/s, and e = (1 - rho / rho_0) / (1 -
/// rho_alone / rho_0) the exposed share of the particle: 1 for a drop of one particle of any size, 0 inside
/// the water. The step is exact for a constant e, so that a lone drop reaches the terminal speed g / k.
struct AirDrag {
  const float* density;
  const std::uint8_t* level;
  Vec4* velocity;
  float rate;    ///< k dt
  float alone;   ///< rho / rho_0 of a lone particle
  int coarsest;  ///< coarsest level that air brakes

  SIM_FN void operator()(int i) const {
    if (level[i] > coarsest) return;
    const float exposed = at_least(1 - density[i], 0.0f) / (1 - alone);
    velocity[i] = with_w(expf(-rate * at_most(exposed, 1.0f)) * xyz(velocity[i]), 0);
  }
};

using AirDragColumns =
    ColumnView<columns(Column::Level, Column::Density, Column::Velocity), columns(Column::Velocity)>;

void run_air_drag(FluidState& state, AirDragColumns p) {
  const auto& k = state.parameters;
  for_each("air drag", p.size(),
           AirDrag{.density = p.density(),
                   .level = p.level(),
                   .velocity = p.velocity(),
                   .rate = k.dt * k.effects[EffectKind::AirDrag],
                   .alone = mass_of(1, 1) * Kernel(1).density(0),
                   .coarsest = static_cast<int>(k.effects[EffectOption::AirDragCoarsest])});
}

}  // namespace

std::vector<Stage> air_drag_stages() {
  return {stage_of<run_air_drag>({.name = "air drag", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
