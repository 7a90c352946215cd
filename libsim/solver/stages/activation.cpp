#include "libsim/activation/importance.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float cell_spacings = 10;  ///< edge of the velocity grid's cells, in spacings d_* of level 0

struct ActivateAll {
  std::uint8_t* active;
  SIM_FN void operator()(int i) const { active[i] = 1; }
};

/// Chooses the particles that the frame solves: ViP-Fluid, Algorithm 3, lines 8 and 9.
struct Choose {
  const Vec4* position;
  const int* id;
  const std::uint8_t* level;
  const float* importance;
  const ValueRange* range;
  const std::uint8_t* age;  ///< frames since a split or merge made it; nullptr if nothing splits or merges
  Vec4* velocity;
  std::uint8_t* active;
  int* start_cell;
  float* probability;
  GridFrame grid, change_cells;
  const Vec4* mean_velocity;
  bool within_frame;
  float beta, dt;
  std::uint32_t frame, seed;
  Solids solids;
  const FreeBody* free;  ///< one per body; nullptr if no obstacle is free

  SIM_FN void operator()(int i) const {
    const Vec3 x = xyz(position[i]);
    const float p = beta + (1 - beta) * range->normalised(importance[i]);
    probability[i] = p;
    start_cell[i] = change_cells.cell_of(x);
    const bool drawn = activation_draw(static_cast<std::uint32_t>(id[i]), frame, seed) < p;
    const Vec4 mean = sample(mean_velocity, level[i] * grid.cells(), grid.corners(x));
    const bool on = drawn || mean.w == value_unknown || (within_frame && (fresh(i) || fast(i) || bears(i)));
    active[i] = on ? 1 : 0;
    if (!on && !within_frame) velocity[i] = with_w(xyz(mean), 0);
  }
  SIM_FN bool fresh(int i) const { return age && age[i] == 0; }
  /// True within a support radius of a free body, whose weight the particle's pressure bears.
  SIM_FN bool bears(int i) const {
    if (!free) return false;
    for (int b = 0; b < solids.count; ++b) {
      if (free[b].mass > 0 && solids.distance(b, xyz(position[i])) < position[i].w) return true;
    }
    return false;
  }
  SIM_FN bool fast(int i) const { return length(xyz(velocity[i])) * dt > 0.5f * position[i].w; }
};

using ActivationColumns = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                                     columns(Column::Active, Column::StartCell, Column::Velocity),
                                     columns(Column::Saliency, Column::Age)>;

/// Measures the particles' importance, ViP-Fluid Eq. 12-14, and the range that normalises the importance.
void measure(FluidState& state, ActivationColumns p) {
  auto& a = state.activation;
  const float spacing = 0.5f * state.finest_support;
  const float speed_floor = fmaxf(a.rules.speed_floor * sqrtf(state.gravity_of_rest() * spacing), 1e-6f);
  measure_importance(a, p, p.saliency(), speed_floor);
}

void choose(FluidState& state, ActivationColumns p) {
  auto& a = state.activation;
  for_each("choose active", p.size(),
           Choose{.position = p.position(),
                  .id = p.id(),
                  .level = p.level(),
                  .importance = a.importance.data(),
                  .range = a.range.range(),
                  .age = p.age(),
                  .velocity = p.velocity(),
                  .active = p.active(),
                  .start_cell = p.start_cell(),
                  .probability = a.probability.data(),
                  .grid = a.grid.frame(),
                  .change_cells = a.change_cells,
                  .mean_velocity = a.grid.velocity().data(),
                  .within_frame = a.rules.within_frame,
                  .beta = a.beta,
                  .dt = state.parameters.dt,
                  .frame = a.frame,
                  .seed = a.seed,
                  .solids = state.solids(),
                  .free = state.obstacles.free.size() > 0 ? state.obstacles.free.data() : nullptr});
}

void run_activation(FluidState& state, ActivationColumns p) {
  auto& a = state.activation;
  const int n = p.size();
  a.grid.fit(state.domain, cell_spacings * 0.5f * state.finest_support);
  a.change_cells = cells_over(state.domain, a.rules.change_spacings * 0.5f * state.finest_support);
  if (!a.columns_set) a.grid.forget();
  // After splits and merges in weightless water, the stage parting moves all particles, so all are solved.
  const bool parts = state.parameters.weightless() && state.levels.changed;
  const bool one_substep = a.rules.within_frame && state.parameters.substeps < 2;
  a.some_rest = a.beta < 1 && n > 0 && !parts && !one_substep;
  if (!a.columns_set || (!a.some_rest && !a.all_marked)) for_each("activate all", n, ActivateAll{p.active()});
  a.columns_set = true;
  a.all_marked = !a.some_rest;
  state.all_active = !a.some_rest;
  if (!a.some_rest) return;
  measure(state, p);
  a.probability.resize(static_cast<std::size_t>(n));
  choose(state, p);
  if (!a.rules.within_frame) return;
  a.before.measure(
      p, p.active(),
      {{Whose::Solved, a.change_cells, p.start_cell()}, {Whose::Resting, a.change_cells, p.start_cell()}});
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
