#include <algorithm>
#include <cmath>

#include "libsim/particles/calm.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// v += (x* - (x + dt v)) / dt, with x* the predicted position: equal to v = (x* - x) / dt, but without the
/// rounding of x if no projection moves the particle. The fourth component of the velocity becomes the degree
/// of rest, 0 to 1. The viscosity pass reads it and resets it to 0. With levels, and in short substeps, water
/// is at rest if the mean motion of its surroundings (the column Drift) is slow. The particle's own speed
/// does not count: in short substeps the projections make every particle jitter, at rest as in a wave.
struct Advance {
  Vec4* position;
  const Vec4* predicted;
  /// predicted positions before the projections; only in substeps after a rest, else nullptr
  const Vec4* before;
  TimeOfRest time;
  Vec4* velocity;
  /// output: velocity change in the substep, which RestingWater filters near new particles; nullptr if
  /// nothing splits or merges
  Vec4* kick;
  Brake brake;
  float dt;
  const Vec4* drift;     ///< nullptr if particles are at rest by their own speed
  Calm still;            ///< criterion of rest for the finest particles
  float finest_support;  ///< support of particles of level 0, m
  /// true: particles that were at rest before this substep's velocity change count as at rest too
  bool before_kicks;
  SIM_FN void operator()(int i) const {
    const Vec3 v = xyz(velocity[i]);
    const Vec3 free = fused(xyz(position[i]), dt, v);
    Vec3 after = v + (1 / dt) * (xyz(predicted[i]) - free);
    if (before) after += ((1 / time(i) - 1) / dt) * (xyz(predicted[i]) - xyz(before[i]));
    const Vec3 kept = brake.limited(after, predicted[i].w, i);
    if (drift) {
      velocity[i] = with_w(kept, at_most(2 * still.of_square(drift[i].w), 1.0f));
    } else {
      const float now = rest(kept, predicted[i].w);
      velocity[i] = with_w(kept, before_kicks ? at_least(now, rest(v, predicted[i].w)) : now);
    }
    if (kick) kick[i] = with_w(xyz(velocity[i]) - v, 0);
    // No particle moves farther than the speed limit allows: many particles at one position would otherwise
    // be thrown far into other water in one substep.
    position[i] = length(after) > brake.most_speed ? with_w(fused(xyz(position[i]), dt, kept), predicted[i].w)
                                                   : predicted[i];
  }
  /// Degree of rest of a particle with support h. The speed below which a particle counts as at rest
  /// increases with the root of its spacing.
  SIM_FN float rest(Vec3 v, float h) const {
    const Vec3 finer = sqrtf(finest_support / h) * v;
    return still(finer.x, finer.y, finer.z);
  }
};

using VelocityColumns =
    ColumnView<columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id),
               columns(Column::Velocity, Column::Position),
               columns(Column::VelocityNext, Column::Active, Column::Drift), columns(Column::PredictedNext)>;

void run_velocity(FluidState& state, VelocityColumns p) {
  const auto& k = state.parameters;
  // The projections leave a jitter of a small share of the spacing d, which is a speed in proportion to d /
  // dt. In short substeps this speed would exceed the limit below which particles count as at rest, so the
  // limit is raised.
  const double shorter = k.shortness(state.finest_support);
  const bool drifts = p.has(Column::Drift) && (!state.one_level || state.one_level_rests_by_drift);
  const double still_speed = static_cast<double>(k.still_speed) * std::pow(std::max(1.0, shorter), 0.25);
  // PredictedNext stores the velocity changes, because its positions are no longer needed.
  Vec4* kick = p.has(Column::Ease) ? p.predicted_next() : nullptr;
  for_each("velocity", p.size(),
           Advance{.position = p.position(),
                   .predicted = p.predicted(),
                   .before = state.after_rest() ? p.velocity_next() : nullptr,
                   .time = state.time_of_rest(),
                   .velocity = p.velocity(),
                   .kick = kick,
                   .brake = state.brake(p.id(), 1),
                   .dt = k.dt,
                   .drift = drifts ? p.drift() : nullptr,
                   .still = drifts ? state.drift_calm(1) : state.calm_under(still_speed),
                   .finest_support = state.finest_support,
                   .before_kicks = shorter > 1});
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

using BeforeColumns = ColumnView<columns(Column::Predicted), columns(Column::VelocityNext)>;

void run_before_projections(FluidState& state, BeforeColumns p) {
  if (state.after_rest()) p.copy<Column::VelocityNext, Column::Predicted>();
}

}  // namespace

Stage before_projections_stage() {
  return stage_of<run_before_projections>(
      {.name = "before projections",
       .source = "positions before the projections, for rests of one substep",
       .phase = Phase::Substep,
       .called_for = if_activation});
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
