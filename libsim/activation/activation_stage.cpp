#include "libsim/activation/importance.hpp"
#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float cell_spacings = 10;  ///< edge of the velocity grid's cells in d_*
constexpr float range_share = 0.1f;  ///< a frame, of the way to the new percentiles

struct ActivateAll {
  std::uint8_t* active;
  std::uint8_t* rest;
  SIM_FN void operator()(int i) const {
    active[i] = 1;
    rest[i] = 0;
  }
};

/// Algorithm 3, lines 8 and 9.
struct Choose {
  const Vec4* position;
  const int* id;
  const std::uint8_t* level;
  const float* importance;
  const ValueRange* range;
  const std::uint8_t* age;  ///< nullptr where nothing splits or merges
  Vec4* velocity;
  std::uint8_t* active;
  std::uint8_t* rest;
  int* start_cell;
  float* probability;
  GridFrame grid, near;
  const Vec4* mean_velocity;
  Walls walls;
  ActivationRules rules;
  float beta, dt;
  std::uint32_t frame, seed;

  SIM_FN void operator()(int i) const {
    const float p = beta + (1 - beta) * range->normalised(importance[i]);
    probability[i] = p;
    start_cell[i] = near.cell_of(xyz(position[i]));
    const int count = rest[i] & rest_count_mask;
    const bool on = activation_draw(static_cast<std::uint32_t>(id[i]), frame, seed) < p || must_be_solved(i);
    active[i] = on;
    rest[i] = static_cast<std::uint8_t>((rest[i] & ~rest_count_mask) | count_after(count, on));
    if (on) return;
    if (!rules.inherit_change) {
      const CellCorners corners = grid.corners(xyz(position[i]));
      velocity[i] = with_w(xyz(sample(mean_velocity, level[i] * grid.cells(), corners)), 0);
    }
  }

  /// Counts the frames of a rest, then on from the longest one while the particle must be solved; 0: it may
  /// rest.
  SIM_FN int count_after(int count, bool on) const {
    if (!on) return count < rest_count_mask ? count + 1 : count;
    if (rules.longest_rest <= 0 || count == 0) return 0;
    const int next = (count < rules.longest_rest ? rules.longest_rest : count) + 1;
    return next < rules.longest_rest + rules.least_work ? next : 0;
  }

  SIM_FN bool must_be_solved(int i) const {
    if (rest[i] & rest_nowhere) return true;
    if (rules.longest_rest > 0 && (rest[i] & rest_count_mask) >= rules.longest_rest) return true;
    if (!rules.keep_fragile_active) return false;
    const Vec4 x = position[i];
    if (age && age[i] == 0) return true;
    const bool fast = length(xyz(velocity[i])) * dt > 0.5f * x.w;
    return fast || (rest[i] & rest_sparse) || walls.nearest(xyz(x)) < x.w;
  }
};

void choose(FluidState& state) {
  auto& a = state.activation;
  auto& p = state.particles;
  const int n = p.size();
  const auto& k = state.parameters;
  a.grid.fit(state.domain, cell_spacings * 0.5f * state.finest_support);
  a.near.fit(state.domain, a.rules.near_spacings * 0.5f * state.finest_support);
  state.all_active = a.beta >= 1 || n == 0;
  if (!a.columns_set || (state.all_active && !a.all_marked))
    for_each("activate all", n, ActivateAll{p.active.data(), p.rest.data()});
  a.columns_set = true;
  a.all_marked = state.all_active;
  if (state.all_active) return;
  const float spacing = 0.5f * state.finest_support;
  const float speed_floor = fmaxf(a.rules.speed_floor * sqrtf(k.gravity * spacing), 1e-6f);
  measure_importance(a, p, p.has(Column::Saliency) ? p.saliency.data() : nullptr, speed_floor);
  if (a.rules.robust_range) {
    a.range.follow_percentiles(a.importance, n, range_share);
  } else {
    a.range.take_extremes(a.importance, n);
  }
  a.probability.resize(static_cast<std::size_t>(n));
  for_each("choose active", n,
           Choose{p.position.data(),
                  p.id.data(),
                  p.level.data(),
                  a.importance.data(),
                  a.range.range(),
                  p.has(Column::Age) ? p.age.data() : nullptr,
                  p.velocity.data(),
                  p.active.data(),
                  p.rest.data(),
                  p.start_cell.data(),
                  a.probability.data(),
                  a.grid.frame(),
                  a.near.frame(),
                  a.grid.velocity().data(),
                  state.walls,
                  a.rules,
                  a.beta,
                  k.dt,
                  a.frame,
                  a.seed});
  if (!a.rules.inherit_change) return;
  add_momentum(p, p.active.data(), p.start_cell.data(), a.near.frame(), a.before);
  if (a.rules.pressed)
    add_momentum(p, p.active.data(), p.start_cell.data(), a.near.frame(), a.others_before, 0);
}

/// Mean change of velocity of a cell and level's active particles over the frame, less what the others of the
/// cell have already met; what is empty takes the mean of the other levels.
struct MeanChange {
  const MomentumSum* before;
  const MomentumSum* after;
  const MomentumSum* others_before;  ///< nullptr unless something moved the others too
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

/// Algorithm 3, line 15, once all active particles are done: what was not solved takes its velocity from the
/// grid. Its way is mended as if the change had come in equal parts in the frame's substeps.
struct Inherit {
  const std::uint8_t* active;
  const std::uint8_t* level;
  Vec4* position;
  Vec4* velocity;
  Guards* guards;
  GridFrame grid;
  const Vec4* change;
  const Vec4* mean_velocity;
  Walls walls;
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
    if (walls.project(x, wall_gap * h / 2)) atomic_add(&guards->wall_projected, std::uint64_t{1});
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

void inherit(FluidState& state) {
  auto& a = state.activation;
  auto& p = state.particles;
  const auto& k = state.parameters;
  const int cells = grid_levels * a.near.cells();
  if (a.rules.inherit_change) {
    add_momentum(p, p.active.data(), p.start_cell.data(), a.near.frame(), a.after);
    a.change.resize(static_cast<std::size_t>(cells));
    if (a.rules.pressed)
      add_momentum(p, p.active.data(), p.start_cell.data(), a.near.frame(), a.others_after, 0);
    for_each("mean change", cells,
             MeanChange{a.before.data(), a.after.data(), a.rules.pressed ? a.others_before.data() : nullptr,
                        a.others_after.data(), a.change.data(), a.near.cells()});
  }
  // As printed, the mean velocities are those of V.
  const VelocityGrid& from = a.rules.inherit_change ? a.near : a.grid;
  if (a.rules.inherit_change && a.rules.damping > 0) a.near.update_velocity(p, p.active.data());
  const auto substeps = static_cast<float>(k.substeps);
  const float idle = 1 - a.beta;
  const float mean_share = a.rules.inherit_change ? a.rules.damping * idle * idle : 1;
  const float frame_dt = k.dt * substeps;
  for_each("inherit", p.size(),
           Inherit{p.active.data(), p.level.data(), p.position.data(), p.velocity.data(), state.guard(),
                   from.frame(), a.change.data(), from.velocity().data(), state.walls, frame_dt,
                   frame_dt * (substeps + 1) / (2 * substeps), k.wall_gap, mean_share});
}

/// Marks spray, which no grid may move.
struct MarkSparse {
  const std::uint8_t* active;
  const float* density;
  std::uint8_t* rest;
  SIM_FN void operator()(int i) const {
    if (active[i])
      rest[i] = static_cast<std::uint8_t>((rest[i] & rest_count_mask) |
                                          (density[i] < sparse_density ? rest_sparse : 0));
  }
};

/// Algorithm 3, lines 4-5 and 13-17, in two passes: line 15 reads the grid that line 13 is still writing.
void update_grid(FluidState& state) {
  auto& a = state.activation;
  auto& p = state.particles;
  a.grid.update_velocity(p, state.all_active ? nullptr : p.active.data());
  if (!state.all_active) inherit(state);
  a.grid.update_energy(p);
  for_each("mark sparse", p.size(), MarkSparse{p.active.data(), p.density.data(), p.rest.data()});
  state.all_active = true;
}

std::string wanted(const Demand& demand) {
  return demand.activation && !demand.settling ? "the method accelerates in time" : "";
}

}  // namespace

Stage activation_stage() {
  return {"activation",
          "ViP-Fluid, Algorithm 3 lines 8-9, Eq. 12-14",
          Phase::FrameStart,
          columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
          columns(Column::Active, Column::Rest, Column::StartCell, Column::Velocity),
          wanted,
          choose,
          Part::Activation};
}

Stage velocity_grid_stage() {
  return {"velocity grid",
          "ViP-Fluid, Algorithm 3 lines 4-5 and 13-17",
          Phase::FrameEnd,
          columns(Column::Position, Column::Velocity, Column::Level, Column::Density, Column::Active,
                  Column::Rest, Column::StartCell),
          columns(Column::Velocity, Column::Position, Column::Rest),
          wanted,
          update_grid,
          Part::Activation};
}

}  // namespace sim::SIM_BACKEND
