#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// The velocity change that the resting particles of a cell and level lack: the mean change, over the frame,
/// of the particles solved in every substep, minus that of the resting ones. Where one of these two groups is
/// empty, the mean of the cell's other levels stands in.
struct MissingChange {
  const MomentumSum* before;
  const MomentumSum* after;
  const MomentumSum* resting_before;
  const MomentumSum* resting_after;
  Vec4* change;
  int cells;

  SIM_FN void operator()(int i) const {
    Vec4 own = of(i);
    if (own.w == value_unknown) own = of_others(i % cells);
    change[i] = own;
  }
  SIM_FN Vec4 of(int i) const {
    for (const auto* sums : {before, after, resting_before, resting_after})
      if (sums[i].mass == 0) return {0, 0, 0, value_unknown};
    const Vec3 out = mean_velocity(after[i]) - mean_velocity(before[i]) + mean_velocity(resting_before[i]) -
                     mean_velocity(resting_after[i]);
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

/// Gives the particles that rested within the frame the velocity change that they lack, interpolated at their
/// positions at the frame's start, about `frame_dt` earlier.
struct CatchUp {
  const std::uint8_t* active;
  const std::uint8_t* level;
  const Vec4* position;
  Vec4* velocity;
  GridFrame grid;
  const Vec4* change;
  float frame_dt;

  SIM_FN void operator()(int i) const {
    if (active[i]) return;
    const Vec3 v = xyz(velocity[i]);
    const Vec3 start = xyz(position[i]) - frame_dt * v;
    velocity[i] = with_w(v + xyz(sample(change, level[i] * grid.cells(), grid.corners(start))), 0);
  }
};

/// ViP-Fluid, Algorithm 3, line 15, for whole-frame rests, after all solved particles have moved: unsolved
/// particles take the mean velocity of the grid. Their displacement is corrected as if the change had come in
/// equal parts in the frame's substeps.
template <class Boundary>
struct Inherit {
  const std::uint8_t* active;
  const std::uint8_t* level;
  Vec4* position;
  Vec4* velocity;
  Guards* guards;
  GridFrame grid;
  const Vec4* mean_velocity;
  Boundary walls;
  float way_dt, wall_gap;

  SIM_FN void operator()(int i) const {
    if (active[i]) return;
    const float h = position[i].w;
    Vec3 x = xyz(position[i]);
    const Vec4 mean = sample(mean_velocity, level[i] * grid.cells(), grid.corners(x));
    if (mean.w == value_unknown) return;
    x += way_dt * (xyz(mean) - xyz(velocity[i]));
    velocity[i] = with_w(xyz(mean), 0);
    if (walls.project(x, xyz(position[i]), wall_gap * h / 2))
      atomic_add(&guards->wall_projected, std::uint64_t{1});
    position[i] = with_w(x, h);
  }
};

using VelocityGridColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Level, Column::Active, Column::StartCell),
               columns(Column::Velocity, Column::Position)>;

/// Computes the mean velocities V, and the changes that particles lack after they rested within the frame:
/// one launch over the particles, one over the cells' sums.
void find_means(FluidState& state, VelocityGridColumns p) {
  auto& a = state.activation;
  const bool changes = a.rests_within_frame();
  const auto only_if_changes = [&](Whose whose) { return changes ? whose : Whose::Unused; };
  const bool whole_frame_rests = a.some_rest && !a.rules.within_frame;
  a.after.measure(p, p.active(),
                  {{only_if_changes(Whose::Solved), a.change_cells, p.start_cell()},
                   {only_if_changes(Whose::Resting), a.change_cells, p.start_cell()},
                   {whole_frame_rests ? Whose::Solved : Whose::All, a.grid.frame()}});
  const int cells = a.change_cells.cells();
  const int changing = changes ? grid_levels * cells : 0;
  a.change.resize(static_cast<std::size_t>(changing));
  for_each_pass("mean velocities",  //
                a.grid.finish_velocity(a.after.of(sum_of_grid)),
                Pass<MissingChange>{changing,
                                    {.before = a.before.of(sum_of_solved),
                                     .after = a.after.of(sum_of_solved),
                                     .resting_before = a.before.of(sum_of_resting),
                                     .resting_after = a.after.of(sum_of_resting),
                                     .change = a.change.data(),
                                     .cells = cells}});
}

void catch_up(FluidState& state, VelocityGridColumns p) {
  auto& a = state.activation;
  for_each("catch up", p.size(),
           CatchUp{.active = p.active(),
                   .level = p.level(),
                   .position = p.position(),
                   .velocity = p.velocity(),
                   .grid = a.change_cells,
                   .change = a.change.data(),
                   .frame_dt = state.parameters.dt * static_cast<float>(state.parameters.substeps)});
}

template <class Boundary>
void inherit(FluidState& state, VelocityGridColumns p, Boundary boundary) {
  auto& a = state.activation;
  const auto& k = state.parameters;
  const auto substeps = static_cast<float>(k.substeps);
  for_each("inherit", p.size(),
           Inherit<Boundary>{.active = p.active(),
                             .level = p.level(),
                             .position = p.position(),
                             .velocity = p.velocity(),
                             .guards = state.guard(),
                             .grid = a.grid.frame(),
                             .mean_velocity = a.grid.velocity().data(),
                             .walls = boundary,
                             .way_dt = k.dt * (substeps + 1) / 2,
                             .wall_gap = k.wall_gap});
}

/// ViP-Fluid, Algorithm 3, lines 4-5 and 13-17. Two passes are needed, because line 15 reads the grid that
/// line 13 writes.
void run_velocity_grid(FluidState& state, VelocityGridColumns p) {
  auto& a = state.activation;
  find_means(state, p);
  if (a.rests_within_frame()) {
    catch_up(state, p);
  } else if (a.some_rest) {
    state.obstacles.exists() ? inherit(state, p, state.solids()) : inherit(state, p, state.walls);
  }
  a.grid.update_energy(p);
  a.some_rest = false;
  state.all_active = true;
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
