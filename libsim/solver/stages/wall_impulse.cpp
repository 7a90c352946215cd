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

/// rho_0 q A of the cells at a wall: by Gauss' theorem the sum of -rho_0 grad q over the water.
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
    const Vec3 half{frame.edge.x / 2, frame.edge.y / 2, frame.edge.z / 2};
    const Vec3 centre = frame.in_metres(
        {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, static_cast<float>(z) + 0.5f});
    const auto push = [&](Wall wall, int nx, int ny, int nz, float area) {
      if (grid.kind_at(nx, ny, nz) != CellKind::Solid) return;
      const float shut = grid.open_count > 0 ? 1 - grid.openness(nx, ny, nz) : 1.0f;
      to.add(static_cast<int>(wall), WallPart::CoarsePressure, centre, half,
             shut * grid.q[i] * area / unit_volume);
    };
    const float across_x = frame.edge.y * frame.edge.z;
    const float across_z = frame.edge.x * frame.edge.y;
    push(Wall::LowX, x - 1, y, z, across_x);
    push(Wall::HighX, x + 1, y, z, across_x);
    push(Wall::LowZ, x, y, z - 1, across_z);
    push(Wall::HighZ, x, y, z + 1, across_z);
    push(Wall::Floor, x, y - 1, z, frame.floor_area());
  }
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
  Vec4* next;  ///< nullptr where it holds other places
  Walls walls;
  WallListener to;
  Guards* guards;
  float wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = predicted[i];
    Vec3 x = xyz(at);
    if (!walls.project(x, xyz(from[i]), wall_gap * at.w / 2, HeardClamp{to, at})) return;
    atomic_add(&guards->wall_projected, std::uint64_t{1});
    predicted[i] = with_w(x, at.w);
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
