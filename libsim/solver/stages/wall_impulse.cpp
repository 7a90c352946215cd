/// What the walls give the water, told to the account (libsim/impulse) beside the passes that do it.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// What Predict did, told again.
struct HeldBack {
  const Vec4* position;
  const Vec4* velocity;
  Walls walls;
  WallListener to;
  float dt, wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    Vec3 x = xyz(at);
    walls.hold_back(x, fused(x, dt, xyz(velocity[i])), wall_gap * at.w / 2, HeardClamp{to, at});
  }
};

using MovingView = Reads<Column::Position, Column::Velocity>;

void hear_held_back(FluidState& state, MovingView p) {
  for_each("hear held back", p.size(),
           HeldBack{.position = p.position(),
                    .velocity = p.velocity(),
                    .walls = state.walls,
                    .to = state.impulse.listener(),
                    .dt = state.parameters.dt,
                    .wall_gap = state.parameters.wall_gap});
}

/// Delta p_i = w_i lambda_i grad_i C_wall of the displacement to come, wall by wall.
struct MissingDensity {
  const Vec4* predicted;
  const float* lambda;
  Walls walls;
  WallListener to;
  float mass_unit;  ///< m_*, kg
  SIM_FN void operator()(int i) const {
    if (lambda[i] == 0) return;
    const Vec4 at = predicted[i];
    for (int k = 0; k < walls.count; ++k) {
      const float slope = walls.missing_slope(k, xyz(at), at.w);
      if (slope != 0) to.add(k, WallPart::MissingDensity, xyz(at), at.w, lambda[i] * slope / mass_unit);
    }
  }
};

using ConstraintView = Reads<Column::Predicted, Column::Lambda>;

void hear_missing_density(FluidState& state, ConstraintView p) {
  const auto& k = state.parameters;
  for_each("hear missing density", p.size(),
           MissingDensity{.predicted = p.predicted(),
                          .lambda = p.lambda(),
                          .walls = state.walls,
                          .to = state.impulse.listener(times_taken(k, state.iteration)),
                          .mass_unit = mass_of(state.finest_support, k.rest_density)});
}

/// The pressure of the cells at a wall, as push_balance.cpp counts it. Gauges may be smaller than a cell:
/// within a face the pressure follows its neighbours, on patches that sum up to the face.
struct WallCells {
  PressureFrame frame;
  GridView grid;
  WallListener to;
  float unit_volume;  ///< of m_*, m3

  SIM_FN void operator()(int i) const {
    if (grid.kind[i] != CellKind::Fluid || grid.q[i] <= 0) return;
    const CellBlock& block = grid.block;
    const int x = i % block.nx;
    const int y = i / block.nx % block.ny;
    const int z = i / (block.nx * block.ny);
    const auto middle = [](int cell) { return static_cast<float>(cell) + 0.5f; };
    const Vec3 centre{middle(x), middle(y), middle(z)};
    const float q = grid.q[i];
    const Vec3 slope{slope_of(q, x, y, z, 1, 0, 0), slope_of(q, x, y, z, 0, 1, 0),
                     slope_of(q, x, y, z, 0, 0, 1)};
    for_wall_faces(frame, grid, i, [&](int wall, Vec3 normal, float area) {
      const float share = area / (unit_volume * patches * patches);
      for (int a = 0; a < patches; ++a) {
        for (int b = 0; b < patches; ++b) {
          const float first = middle(a) / patches - 0.5f;
          const float second = middle(b) / patches - 0.5f;
          // Along the wall; across it a patch lies where its cell does.
          const Vec3 from = normal.x != 0   ? Vec3{0, first, second}
                            : normal.y != 0 ? Vec3{first, 0, second}
                                            : Vec3{first, second, 0};
          to.add(wall, WallPart::CoarsePressure, frame.in_metres(centre + from),
                 (0.5f / patches) * frame.edge, (q + dot(slope, from)) * share);
        }
      }
    });
  }
  /// Change of q over the cell, which nowhere in it falls below 0.
  SIM_FN float slope_of(float q, int x, int y, int z, int dx, int dy, int dz) const {
    const float before = q_beside(q, x - dx, y - dy, z - dz);
    const float after = q_beside(q, x + dx, y + dy, z + dz);
    return fminf(fmaxf((after - before) / 2, -2 * q), 2 * q);
  }
  SIM_FN float q_beside(float q, int x, int y, int z) const {
    return grid.kind_at(x, y, z) == CellKind::Solid ? q : grid.q_at(x, y, z);
  }
  static constexpr int patches = 4;
};

void hear_wall_cells(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  const GridView grid = state.coarse.multigrid.finest();
  for_each("hear wall cells", grid.block.size(),
           WallCells{.frame = state.coarse.frame,
                     .grid = grid,
                     .to = state.impulse.listener(),
                     .unit_volume = mass_of(state.finest_support, 1)});
}

struct Clamp {
  Vec4* predicted;
  const Vec4* from;
  Vec4* next;  ///< nullptr where it goes on holding other places
  Walls walls;
  WallListener to;
  Guards* guards;
  float wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = predicted[i];
    Vec3 x = xyz(at);
    if (walls.project(x, xyz(from[i]), wall_gap * at.w / 2, HeardClamp{to, at})) {
      atomic_add(&guards->wall_projected, std::uint64_t{1});
      predicted[i] = with_w(x, at.w);
    }
    if (next) next[i] = predicted[i];
  }
};

Stage account(const char* name, Phase phase) {
  return {
      .name = name, .source = "what the walls give the water", .phase = phase, .called_for = if_wall_impulse};
}

}  // namespace

float gap_of_kernels(const FluidState& state) {
  constexpr float none = -1e30f;
  return state.impulse.listens() ? none : state.parameters.wall_gap;
}

void clamp_and_listen(FluidState& state, ClampView p, const Vec4* from, float times, bool in_both) {
  if (!state.impulse.listens()) return;
  for_each("clamp and hear", p.size(),
           Clamp{.predicted = p.predicted(),
                 .from = from,
                 .next = in_both ? p.predicted_next() : nullptr,
                 .walls = state.walls,
                 .to = state.impulse.listener(times),
                 .guards = state.guard(),
                 .wall_gap = state.parameters.wall_gap});
}

float times_taken(const SolverParameters& k, int iteration) {
  float out = 0;
  float share = 1;
  for (int i = iteration; i < k.iterations; ++i, share *= k.momentum) out += share;
  return out;
}

Stage held_at_walls_stage() { return stage_of<hear_held_back>(account("held at walls", Phase::Substep)); }

Stage missing_density_stage() {
  return stage_of<hear_missing_density>(account("walls' density", Phase::Iteration));
}

Stage wall_cells_stage() {
  Stage stage = account("walls' cells", Phase::Substep);
  stage.called_for = [](const Demand& demand) -> std::string {
    return demand.parameters.coarse_cycles > 0 ? if_wall_impulse(demand) : "";
  };
  return stage_of<hear_wall_cells>(stage);
}

}  // namespace sim::SIM_BACKEND
