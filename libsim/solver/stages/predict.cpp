#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Weight {
  Vec3 lift;  ///< minus the acceleration of gravity, m/s2
  /// Changes the velocity v by the acceleration during dt.
  SIM_FN void act(Vec3, Vec3& v, float dt) const { v = v - dt * lift; }
};

struct WeightAndPull {
  Weight down;
  CentralPull pull;
  SIM_FN void act(Vec3 x, Vec3& v, float dt) const {
    down.act(x, v, dt);
    const Vec3 from = x - pull.centre;
    v += -(pull.strength * dt) * (from - dot(from, pull.axis) * pull.axis);
  }
};

/// Used in a substep whose forces have already acted (the stage forces).
struct NoForces {
  SIM_FN void act(Vec3, Vec3&, float) const {}
};

/// Changes a particle's velocity before the particle moves: quarantine, forces and speed limit.
template <class Selection, class Forces, class Boundary>
struct Drive {
  Selection select;
  Forces forces;
  Vec4* position;
  Vec4* velocity;
  Boundary walls;
  Vec3 refuge;
  Brake brake;
  float dt;
  float reach;  ///< distance beyond a wall, m, from which a position counts as lost

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
    velocity[i] = with_w(brake.limited(v, h, i), 0);
  }

  /// Sets the velocity of a particle to zero if its velocity or its position is lost. A position is lost if
  /// it is not finite or farther than `reach` beyond a wall; the particle is then moved to a fixed position
  /// (FluidState::refuge). Other particles never read lost values.
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

/// Drives each particle and moves it to its predicted position. An unsolved particle moves too, at its
/// inherited velocity.
template <class Selection, class Forces, class Boundary>
struct Predict {
  Drive<Selection, Forces, Boundary> drive;
  Vec4* predicted;
  float wall_gap;

  SIM_FN void operator()(int i) const {
    drive(i);
    const float h = drive.position[i].w;
    Vec3 x = xyz(drive.position[i]);
    if (drive.walls.hold_back(x, fused(x, drive.dt, xyz(drive.velocity[i])), wall_gap * h / 2))
      atomic_add(&drive.brake.witness.guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, h);
  }
};

using DriveColumns = ColumnView<columns(Column::Position, Column::Velocity, Column::Id),
                                columns(Column::Position, Column::Velocity)>;

/// Calls then(drive), with a Drive for this selection, these forces and this boundary.
template <class Selection, class Forces, class Boundary, class Then>
void with_drive(FluidState& state, DriveColumns p, Selection select, Forces forces, Boundary boundary,
                Then then) {
  const Vec3 size = state.domain.high - state.domain.low;
  const float longest = at_least(size.x, at_least(size.y, size.z));
  then(Drive<Selection, Forces, Boundary>{.select = select,
                                          .forces = forces,
                                          .position = p.position(),
                                          .velocity = p.velocity(),
                                          .walls = boundary,
                                          .refuge = state.refuge,
                                          .brake = state.brake(p.id(), 0),
                                          .dt = state.parameters.dt,
                                          .reach = 10 * longest});
}

template <class Selection, class Forces, class Then>
void with_drive(FluidState& state, DriveColumns p, Selection select, Forces forces, Then then) {
  state.obstacles.exists() ? with_drive(state, p, select, forces, state.solids(), then)
                           : with_drive(state, p, select, forces, state.walls, then);
}

template <class Forces, class Then>
void with_drive(FluidState& state, DriveColumns p, Forces forces, Then then) {
  state.all_active ? with_drive(state, p, AllParticles{}, forces, then)
                   : with_drive(state, p, state.active(), forces, then);
}

template <class Then>
void with_forces(FluidState& state, DriveColumns p, Then then) {
  const auto& k = state.parameters;
  const Weight down{k.gravity.lift()};
  k.pull.strength > 0 ? with_drive(state, p, WeightAndPull{down, k.pull}, then)
                      : with_drive(state, p, down, then);
}

void run_forces(FluidState& state, DriveColumns p) {
  with_forces(state, p, [&](auto drive) { for_each("forces", p.size(), drive); });
  state.forces_acted = true;
}

using PredictColumns = ColumnView<columns(Column::Position, Column::Velocity, Column::Id),
                                  columns(Column::Predicted, Column::Position, Column::Velocity)>;

void run_predict(FluidState& state, PredictColumns p) {
  const auto move =
      [&]<class Selection, class Forces, class Boundary>(Drive<Selection, Forces, Boundary> drive) {
        for_each("predict", p.size(),
                 Predict<Selection, Forces, Boundary>{drive, p.predicted(), state.parameters.wall_gap});
      };
  state.forces_acted ? with_drive(state, p, NoForces{}, move) : with_forces(state, p, move);
  state.forces_acted = false;
}

}  // namespace

Stage forces_stage() {
  return stage_of<run_forces>({.name = "forces",
                               .source = "Macklin and Mueller 2013, Alg. 1 line 2",
                               .phase = Phase::Substep,
                               .called_for = if_thick,
                               .changes = Change::Forces});
}

Stage predict_stage() {
  return stage_of<run_predict>({.name = "predict",
                                .source = "Macklin and Mueller 2013, Alg. 1 lines 1-4",
                                .phase = Phase::Substep,
                                .called_for = always_moves,
                                .changes = Change::Forces});
}

}  // namespace sim::SIM_BACKEND
