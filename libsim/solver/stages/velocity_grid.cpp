#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Mean velocity change, over the frame, of the solved particles of a cell and level, minus the mean change
/// that the cell's unsolved particles already have. An entry without solved particles takes the mean of the
/// cell's other levels.
struct MeanChange {
  const MomentumSum* before;
  const MomentumSum* after;
  const MomentumSum* others_before;  ///< nullptr unless forces act on unsolved particles
  const MomentumSum* others_after;
  Vec4* change;
  int cells;

  SIM_FN void operator()(int i) const {
    Vec4 own = of(i);
    if (own.w == value_unknown) own = of_others(i % cells);
    change[i] = own;
  }
  SIM_FN Vec4 of(int i) const {
    if (before[i].mass == 0 || after[i].mass == 0) return {0, 0, 0, value_unknown};
    Vec3 out = mean_velocity(after[i]) - mean_velocity(before[i]);
    if (others_before && others_before[i].mass > 0 && others_after[i].mass > 0)
      out += mean_velocity(others_before[i]) - mean_velocity(others_after[i]);
    return with_w(out, value_measured);
  }
  SIM_FN Vec4 of_others(int cell) const {
    Vec3 sum{0, 0, 0};
    float mass = 0;
    for (int level = 0; level < grid_levels; ++level) {
      const Vec4 other = of(level * cells + cell);
      if (other.w == value_unknown) continue;
      const auto weight = static_cast<float>(before[level * cells + cell].mass);
      sum += weight * xyz(other);
      mass += weight;
    }
    return mass > 0 ? with_w((1 / mass) * sum, value_borrowed) : Vec4{0, 0, 0, value_unknown};
  }
};

/// ViP-Fluid, Algorithm 3, line 15, after all solved particles have moved: unsolved particles take their
/// velocity from the grid. Their displacement is corrected as if the change had come in equal parts in the
/// frame's substeps.
template <class Boundary>
struct Inherit {
  const std::uint8_t* active;
  const std::uint8_t* level;
  Vec4* position;
  Vec4* velocity;
  Guards* guards;
  GridFrame grid;
  const Vec4* change;
  const Vec4* mean_velocity;
  Boundary walls;
  float frame_dt, way_dt, wall_gap, mean_share;

  SIM_FN void operator()(int i) const {
    if (active[i]) return;
    const float h = position[i].w;
    Vec3 x = xyz(position[i]);
    const Vec3 v = xyz(velocity[i]);
    Vec3 gain{0, 0, 0};
    if (mean_share < 1) gain = change_at(i, x - frame_dt * v);
    gain += mean_share * (velocity_at(i, x, v + gain) - v - gain);
    velocity[i] = with_w(v + gain, 0);
    x += way_dt * gain;
    if (walls.project(x, xyz(position[i]), wall_gap * h / 2))
      atomic_add(&guards->wall_projected, std::uint64_t{1});
    position[i] = with_w(x, h);
  }
  SIM_FN Vec3 change_at(int i, Vec3 x) const {
    return xyz(sample(change, level[i] * grid.cells(), grid.corners(x)));
  }
  SIM_FN Vec3 velocity_at(int i, Vec3 x, Vec3 otherwise) const {
    const Vec4 v = sample(mean_velocity, level[i] * grid.cells(), grid.corners(x));
    return v.w == value_unknown ? otherwise : xyz(v);
  }
};

/// Marks solved particles of low density: spray and, with surface tension, the surface. If
/// ActivationRules::keep_fragile_active, they are solved in the next frame too.
struct MarkSparse {
  const std::uint8_t* active;
  const float* density;
  std::uint8_t* rest;
  float sparse;  ///< rho / rho_0 below which a particle is marked
  SIM_FN void operator()(int i) const {
    if (active[i])
      rest[i] =
          static_cast<std::uint8_t>((rest[i] & rest_count_mask) | (density[i] < sparse ? rest_sparse : 0));
  }
};

using VelocityGridColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Level, Column::Density, Column::Active,
                       Column::Rest, Column::StartCell),
               columns(Column::Velocity, Column::Position, Column::Rest)>;

/// Computes the mean velocities V, the changes that unsolved particles inherit, and the marks of particles of
/// low density: one launch over the particles, one over the cells' sums.
void find_means(FluidState& state, VelocityGridColumns p) {
  auto& a = state.activation;
  const bool changes = a.some_rest && a.rules.inherit_change;
  const bool pressed = changes && a.rules.pressed;
  const bool means = changes && a.rules.damping > 0;
  const GridFrame near = a.near.frame();
  a.after.measure(p, p.active(),
                  {{changes ? Whose::Solved : Whose::Unused, near, p.start_cell()},
                   {pressed ? Whose::Resting : Whose::Unused, near, p.start_cell()},
                   {a.some_rest && !a.rules.within_frame ? Whose::Solved : Whose::All, a.grid.frame()},
                   {means ? Whose::Solved : Whose::Unused, near}});
  const int changing = changes ? grid_levels * near.cells() : 0;
  a.change.resize(static_cast<std::size_t>(changing));
  const bool tension = state.parameters.effects[EffectKind::Cohesion] > 0;
  for_each_pass(
      "means and marks",  //
      a.grid.finish_velocity(a.after.of(sum_of_grid)), a.near.finish_velocity(a.after.of(sum_of_near)),
      Pass<MeanChange>{changing,
                       {.before = a.before.of(sum_of_solved),
                        .after = a.after.of(sum_of_solved),
                        .others_before = a.before.of(sum_of_resting),
                        .others_after = a.after.of(sum_of_resting),
                        .change = a.change.data(),
                        .cells = near.cells()}},
      Pass<MarkSparse>{p.size(),
                       {p.active(), p.density(), p.rest(), tension ? surface_density : sparse_density}});
}

template <class Boundary>
void inherit(FluidState& state, VelocityGridColumns p, Boundary boundary) {
  auto& a = state.activation;
  const auto& k = state.parameters;
  // Without inherit_change the mean velocities come from Activation::grid, with the cells of ViP-Fluid.
  const VelocityGrid& from = a.rules.inherit_change ? a.near : a.grid;
  const auto substeps = static_cast<float>(k.substeps);
  const float idle = 1 - a.beta;
  const float frame_dt = k.dt * substeps;
  for_each("inherit", p.size(),
           Inherit<Boundary>{.active = p.active(),
                             .level = p.level(),
                             .position = p.position(),
                             .velocity = p.velocity(),
                             .guards = state.guard(),
                             .grid = from.frame(),
                             .change = a.change.data(),
                             .mean_velocity = from.velocity().data(),
                             .walls = boundary,
                             .frame_dt = frame_dt,
                             .way_dt = a.rules.within_frame ? 0 : frame_dt * (substeps + 1) / (2 * substeps),
                             .wall_gap = k.wall_gap,
                             .mean_share = a.rules.inherit_change ? a.rules.damping * idle * idle : 1});
}

/// ViP-Fluid, Algorithm 3, lines 4-5 and 13-17. Two passes are needed, because line 15 reads the grid that
/// line 13 writes.
void run_velocity_grid(FluidState& state, VelocityGridColumns p) {
  Activation& a_ = state.activation;
  find_means(state, p);
  if (a_.some_rest)
    state.obstacles.exists() ? inherit(state, p, state.solids()) : inherit(state, p, state.walls);
  state.activation.grid.update_energy(p);
  state.all_active = true;
  a_.some_rest = false;
}

}  // namespace

Stage velocity_grid_stage() {
  return stage_of<run_velocity_grid>({.name = "velocity grid",
                                      .source = "ViP-Fluid, Algorithm 3 lines 4-5 and 13-17",
                                      .phase = Phase::FrameEnd,
                                      .called_for = if_activation,
                                      .part = Part::Activation,
                                      .changes = Change::Inherited});
}

}  // namespace sim::SIM_BACKEND
