#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Gravity {
  float gravity;
  /// Changes v over a time dt.
  SIM_FN void act(Vec3, Vec3& v, float dt) const { v.y -= gravity * dt; }
};

struct GravityAndPull {
  Gravity down;
  CentralPull pull;
  SIM_FN void act(Vec3 x, Vec3& v, float dt) const {
    down.act(x, v, dt);
    const Vec3 from = x - pull.centre;
    v += -(pull.strength * dt) * (from - dot(from, pull.axis) * pull.axis);
  }
};

/// An unsolved particle moves at its inherited velocity, which includes forces and pressure.
template <class Selection, class Forces, class Boundary>
struct Predict {
  Selection select;
  Forces forces;
  Vec4* position;
  Vec4* velocity;
  Vec4* predicted;
  Boundary walls;
  Vec3 refuge;
  Brake brake;
  float dt, wall_gap;
  float reach;  ///< a position farther beyond a wall is lost, m

  SIM_FN void operator()(int i) const {
    const float h = position[i].w;
    Vec3 x = xyz(position[i]);
    Vec3 v = xyz(velocity[i]);
    quarantine(x, v, h, i);
    position[i] = with_w(x, h);
    if constexpr (Selection::everyone) {
      forces.act(x, v, dt);
    } else {
      forces.act(x, v, select.falls(i) * dt);
    }
    v = brake.limited(v, h, i);
    velocity[i] = with_w(v, 0);
    if (walls.hold_back(x, fused(x, dt, v), wall_gap * h / 2))
      atomic_add(&brake.witness.guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, h);
  }

  /// Sets the velocity to zero. Moves the particle to the refuge if its position is not finite, or so far
  /// outside that at limited speed the walls could not bring it back. The rest of the fluid never reads the
  /// lost values.
  SIM_FN void quarantine(Vec3& x, Vec3& v, float h, int i) const {
    const bool far_outside = all_finite(x) && tank(walls).nearest(x) < -reach;
    const bool place_lost = far_outside || !all_finite(x);
    if (!place_lost && all_finite(v)) return;
    atomic_add(&brake.witness.guards->not_finite, std::uint64_t{1});
    brake.witness.note(far_outside ? Trouble::FarOutside : Trouble::NotFinite, i);
    brake.take(v, h);
    v = {0, 0, 0};
    if (place_lost) x = refuge;
  }
};

using PredictColumns = ColumnView<columns(Column::Position, Column::Velocity, Column::Id),
                                  columns(Column::Predicted, Column::Position, Column::Velocity)>;

template <class Selection, class Forces, class Boundary>
void launch(FluidState& state, PredictColumns p, Selection select, Forces forces, Boundary boundary) {
  const auto& k = state.parameters;
  const Vec3 size = state.domain.high - state.domain.low;
  const float longest = at_least(size.x, at_least(size.y, size.z));
  for_each("predict", p.size(),
           Predict<Selection, Forces, Boundary>{.select = select,
                                                .forces = forces,
                                                .position = p.position(),
                                                .velocity = p.velocity(),
                                                .predicted = p.predicted(),
                                                .walls = boundary,
                                                .refuge = state.refuge,
                                                .brake = state.brake(p.id(), 0),
                                                .dt = k.dt,
                                                .wall_gap = k.wall_gap,
                                                .reach = 10 * longest});
}

template <class Selection, class Forces>
void launch(FluidState& state, PredictColumns p, Selection select, Forces forces) {
  state.obstacles.exists() ? launch(state, p, select, forces, state.solids())
                           : launch(state, p, select, forces, state.walls);
}

template <class Selection>
void launch(FluidState& state, PredictColumns p, Selection select) {
  const auto& k = state.parameters;
  const Gravity down{k.gravity};
  k.pull.strength > 0 ? launch(state, p, select, GravityAndPull{down, k.pull})
                      : launch(state, p, select, down);
}

void run_predict(FluidState& state, PredictColumns p) {
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

}  // namespace

Stage predict_stage() {
  return stage_of<run_predict>({.name = "predict",
                                .source = "Macklin and Mueller 2013, Alg. 1 lines 1-4",
                                .phase = Phase::Substep,
                                .called_for = always_moves,
                                .changes = Change::Forces});
}

}  // namespace sim::SIM_BACKEND
