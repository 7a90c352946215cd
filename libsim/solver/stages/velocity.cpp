#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// v += (x* - (x + dt v)) / dt: equal to (x* - x) / dt, but without the rounding of x if nothing pushes.
struct Advance {
  Vec4* position;
  const Vec4* predicted;
  Vec4* velocity;
  Vec4* kick;  ///< velocity change, for the filter near fresh particles; nullptr without one
  Brake brake;
  float dt;
  SIM_FN void operator()(int i) const {
    const Vec3 v = xyz(velocity[i]);
    const Vec3 free = fused(xyz(position[i]), dt, v);
    const Vec3 after = v + (1 / dt) * (xyz(predicted[i]) - free);
    const Vec3 kept = brake.limited(after, predicted[i].w, i);
    velocity[i] = with_w(kept, 0);
    if (kick) kick[i] = with_w(xyz(velocity[i]) - v, 0);
    // No particle moves farther than the speed limit allows: a crowd in one place would otherwise hit others
    // at once.
    position[i] = length(after) > brake.most_speed ? with_w(fused(xyz(position[i]), dt, kept), predicted[i].w)
                                                   : predicted[i];
  }
};

using VelocityColumns =
    ColumnView<columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id),
               columns(Column::Velocity, Column::Position), ColumnSet{}, columns(Column::PredictedNext)>;

void run_velocity(FluidState& state, VelocityColumns p) {
  // The old positions in PredictedNext are no longer needed.
  Vec4* kick = p.has(Column::Ease) ? p.predicted_next() : nullptr;
  for_each("velocity", p.size(),
           Advance{.position = p.position(),
                   .predicted = p.predicted(),
                   .velocity = p.velocity(),
                   .kick = kick,
                   .brake = state.brake(p.id(), 1),
                   .dt = state.parameters.dt});
}

}  // namespace

Stage velocity_stage() {
  return stage_of<run_velocity>({.name = "velocity",
                                 .source = "Macklin and Mueller 2013, Alg. 1 lines 20-23",
                                 .phase = Phase::SubstepEnd,
                                 .called_for = always_moves,
                                 .changes = Change::Projections});
}

namespace {

struct Damp {
  Vec4* velocity;
  SIM_FN void operator()(int i) const { velocity[i] = with_w(0.9f * xyz(velocity[i]), 0); }
};

using SettlingColumns = ColumnView<columns(Column::Velocity), columns(Column::Velocity)>;

void run_settling(FluidState&, SettlingColumns p) { for_each("settling", p.size(), Damp{p.velocity()}); }

}  // namespace

Stage settling_stage() {
  return stage_of<run_settling>({.name = "settling",
                                 .source = "fill rule of the scenes: velocity x 0.9 each frame",
                                 .phase = Phase::FrameEnd,
                                 .called_for = [](const Demand& demand) -> std::string {
                                   return demand.settling ? "the gate is closed" : "";
                                 }});
}

}  // namespace sim::SIM_BACKEND
