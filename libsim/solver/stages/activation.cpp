#include "libsim/activation/importance.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float cell_spacings = 10;  ///< edge of the velocity grid's cells, in spacings d_* of level 0

struct ActivateAll {
  std::uint8_t* active;
  std::uint8_t* rest;
  SIM_FN void operator()(int i) const {
    active[i] = 1;
    rest[i] = 0;
  }
};

/// Chooses the particles that the frame solves: ViP-Fluid, Algorithm 3, lines 8 and 9.
template <class Boundary>
struct Choose {
  const Vec4* position;
  const int* id;
  const std::uint8_t* level;
  const float* importance;
  const ValueRange* range;
  const std::uint8_t* age;  ///< frames since a split or merge made it; nullptr if nothing splits or merges
  Vec4* velocity;
  std::uint8_t* active;
  std::uint8_t* rest;
  int* start_cell;
  float* probability;
  GridFrame grid, near;
  const Vec4* mean_velocity;
  Boundary walls;
  ActivationRules rules;
  float beta, dt;
  std::uint8_t sparse_mark;  ///< value of Active for solved particles with few neighbours
  std::uint32_t frame, seed;

  SIM_FN void operator()(int i) const {
    const float p = beta + (1 - beta) * range->normalised(importance[i]);
    probability[i] = p;
    start_cell[i] = near.cell_of(xyz(position[i]));
    const int count = rest[i] & rest_count_mask;
    const bool on = activation_draw(static_cast<std::uint32_t>(id[i]), frame, seed) < p || must_be_solved(i);
    const std::uint8_t mark = rest[i] & rest_sparse ? sparse_mark : 1;
    active[i] = on ? mark : 0;
    rest[i] = static_cast<std::uint8_t>((rest[i] & ~rest_count_mask) | count_after(count, on));
    if (on) return;
    if (!rules.inherit_change) {
      const CellCorners corners = grid.corners(xyz(position[i]));
      velocity[i] = with_w(xyz(sample(mean_velocity, level[i] * grid.cells(), corners)), 0);
    }
  }

  /// Next value of the particle's counter. It counts inactive frames. When the particle is solved after them,
  /// the counter continues from longest_rest until the particle has been solved least_work times, and then
  /// becomes 0. At longest_rest or more the particle must be solved; below, it may be inactive.
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
    if (rules.within_frame) return fast;
    return fast || (rest[i] & rest_sparse) || walls.nearest(xyz(x)) < x.w;
  }
};

using ActivationColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
               columns(Column::Active, Column::Rest, Column::StartCell, Column::Velocity),
               columns(Column::Saliency, Column::Age)>;

/// Measures the particles' importance, ViP-Fluid Eq. 12-14, and the range that normalises the importance.
void measure(FluidState& state, ActivationColumns p) {
  auto& a = state.activation;
  const float spacing = 0.5f * state.finest_support;
  const float speed_floor = fmaxf(a.rules.speed_floor * sqrtf(state.gravity_of_rest() * spacing), 1e-6f);
  measure_importance(a, p, p.saliency(), speed_floor);
}

template <class Boundary>
void choose(FluidState& state, ActivationColumns p, Boundary boundary) {
  auto& a = state.activation;
  for_each(
      "choose active", p.size(),
      Choose<Boundary>{
          .position = p.position(),
          .id = p.id(),
          .level = p.level(),
          .importance = a.importance.data(),
          .range = a.range.range(),
          .age = p.age(),
          .velocity = p.velocity(),
          .active = p.active(),
          .rest = p.rest(),
          .start_cell = p.start_cell(),
          .probability = a.probability.data(),
          .grid = a.grid.frame(),
          .near = a.near.frame(),
          .mean_velocity = a.grid.velocity().data(),
          .walls = boundary,
          .rules = a.rules,
          .beta = a.beta,
          .dt = state.parameters.dt,
          .sparse_mark = state.parameters.effects[EffectKind::Cohesion] > 0 ? solved_apart : std::uint8_t{1},
          .frame = a.frame,
          .seed = a.seed});
}

void run_activation(FluidState& state, ActivationColumns p) {
  auto& a = state.activation;
  const int n = p.size();
  a.grid.fit(state.domain, cell_spacings * 0.5f * state.finest_support);
  a.near.fit(state.domain, a.rules.near_spacings * 0.5f * state.finest_support);
  // After splits and merges in weightless water, the stage parting moves all particles, so all are solved.
  const bool parts = state.parameters.weightless() && state.levels.changed;
  state.all_active =
      a.beta >= 1 || n == 0 || parts || (a.rules.within_frame && state.parameters.substeps < 2);
  a.some_rest = !state.all_active;
  if (!a.columns_set || (state.all_active && !a.all_marked))
    for_each("activate all", n, ActivateAll{p.active(), p.rest()});
  a.columns_set = true;
  a.all_marked = state.all_active;
  if (state.all_active) return;
  measure(state, p);
  a.probability.resize(static_cast<std::size_t>(n));
  state.obstacles.exists() ? choose(state, p, state.solids()) : choose(state, p, state.walls);
  if (!a.rules.inherit_change) return;
  const GridFrame near = a.near.frame();
  a.before.measure(p, p.active(),
                   {{Whose::Solved, near, p.start_cell()},
                    {a.rules.pressed ? Whose::Resting : Whose::Unused, near, p.start_cell()}});
}

}  // namespace

Stage activation_stage() {
  return stage_of<run_activation>({.name = "activation",
                                   .source = "ViP-Fluid, Algorithm 3 lines 8-9, Eq. 12-14",
                                   .phase = Phase::FrameStart,
                                   .called_for = if_activation,
                                   .part = Part::Activation});
}

}  // namespace sim::SIM_BACKEND
