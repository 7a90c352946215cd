#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// v += (x* - (x + dt v)) / dt: equal to (x* - x) / dt, but free of the rounding of x while nothing pushes.
struct Advance {
  Vec4* position;
  const Vec4* predicted;
  Vec4* velocity;
  Vec4* kick;  ///< what this changes, for the filter round fresh particles; nullptr without one
  Guards* guards;
  float dt, longest_step;
  SIM_FN void operator()(int i) const {
    const Vec3 v = xyz(velocity[i]);
    const Vec3 free = fused(xyz(position[i]), dt, v);
    const Vec3 after = v + (1 / dt) * (xyz(predicted[i]) - free);
    velocity[i] = with_w(limited(after, longest_step * predicted[i].w / dt, guards), 0);
    if (kick) kick[i] = with_w(xyz(velocity[i]) - v, 0);
    position[i] = predicted[i];
  }
};

struct Damp {
  Vec4* velocity;
  SIM_FN void operator()(int i) const { velocity[i] = with_w(0.9f * xyz(velocity[i]), 0); }
};

}  // namespace

Stage velocity_stage() {
  return {"velocity",
          "Macklin and Mueller 2013, Alg. 1 lines 20-23",
          Phase::SubstepEnd,
          columns(Column::Predicted, Column::Position, Column::Velocity),
          columns(Column::Velocity, Column::Position),
          [](const Demand&) -> std::string { return "every method moves its particles"; },
          [](FluidState& state) {
            auto& p = state.particles;
            // Its old places are done with.
            Vec4* kick = p.has(Column::Ease) ? p.predicted_next.data() : nullptr;
            for_each("velocity", p.size(),
                     Advance{p.position.data(), p.predicted.data(), p.velocity.data(), kick, state.guard(),
                             state.parameters.dt, state.parameters.longest_step});
          }};
}

Stage settling_stage() {
  return {"settling",
          "fill rule of the scenes: velocity x 0.9 each frame",
          Phase::FrameEnd,
          columns(Column::Velocity),
          columns(Column::Velocity),
          [](const Demand& demand) -> std::string { return demand.settling ? "the gate is closed" : ""; },
          [](FluidState& state) {
            for_each("settling", state.particles.size(), Damp{state.particles.velocity.data()});
          }};
}

}  // namespace sim::SIM_BACKEND
