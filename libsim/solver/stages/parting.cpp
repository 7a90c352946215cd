#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Adds the correction made at the substep's beginning to the position and to the predicted position, so that
/// the correction adds no velocity.
template <class Boundary>
struct Follow {
  const Vec4* mended;
  const Vec4* led_to;
  Vec4* position;
  Vec4* predicted;
  Vec4* predicted_next;
  Boundary walls;
  float wall_gap;
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    Vec3 to = xyz(led_to[i]) + (xyz(mended[i]) - xyz(at));
    walls.project(to, xyz(led_to[i]), wall_gap * at.w / 2);
    position[i] = with_w(xyz(mended[i]), at.w);
    predicted[i] = with_w(to, at.w);
    predicted_next[i] = predicted[i];
  }
};

/// Lists the particles that split or merged in this frame, and the particles within their support: all of
/// these have the smallest share of the constraint. Also lists those of their neighbours that are slow, or,
/// with `widely`, all of their neighbours.
template <class Selection>
struct ListBesideFresh {
  Selection select;
  const float* ease;
  const Vec4* velocity;
  Calm slow;  ///< positive for particles that are slow
  float least;
  bool widely;
  Neighbours neighbours;
  int* slots;
  int* count;
  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if (i < 0) return;
    int beside = ease[i] <= least ? 1 : 0;
    const Vec4 v = velocity[i];
    const bool with_neighbours = widely || slow(v.x, v.y, v.z) > 0;
    const int size = with_neighbours && !beside ? neighbours.size(slot) : 0;
    const NeighbourRun run = neighbours.run(slot);
    for (int k = team.rank(); k < size && !beside; k += Team::size)
      if (ease[run[k]] <= least) beside = 1;
    beside = -team.min(-beside);
    if (team.rank() == 0 && beside) slots[atomic_next(count)] = slot;
  }
};

using Places = ColumnView<columns(Column::Predicted), columns(Column::Predicted, Column::PredictedNext,
                                                              Column::Position, Column::VelocityNext)>;

/// Saves the predicted positions in VelocityNext, and resets them to the positions at the substep's
/// beginning.
void go_back(FluidState& state, Places p) {
  state.impulse.pause(true);
  p.copy<Column::VelocityNext, Column::Predicted>();
  p.copy<Column::Predicted, Column::Position>();
  p.copy<Column::PredictedNext, Column::Position>();
}

template <class Boundary>
void follow(FluidState& state, Places p, Boundary boundary) {
  for_each("follow mending", p.size(),
           Follow<Boundary>{.mended = p.predicted(),
                            .led_to = p.velocity_next(),
                            .position = p.position(),
                            .predicted = p.predicted(),
                            .predicted_next = p.predicted_next(),
                            .walls = boundary,
                            .wall_gap = gap_of_kernels(state)});
}

void go_on(FluidState& state, Places p) {
  state.impulse.pause(false);
  state.obstacles.exists() ? follow(state, p, state.solids()) : follow(state, p, state.walls);
  clamp_and_listen(state, p, p.velocity_next(), 1, true);
}

using PartingColumns =
    ColumnView<columns(Column::Predicted, Column::Velocity, Column::Ease, Column::Neighbours, Column::Id),
               columns(Column::Predicted, Column::PredictedNext, Column::Position, Column::VelocityNext,
                       Column::Lambda, Column::Density)>;

/// Separates particles that split or merged in this frame, and those near them. An overlap of length l that
/// remains becomes a speed of about l / dt in one substep. This speed is large compared with that of the
/// water if the water is slow, or if gravity moves a particle by only a small share of its support in a
/// substep. In both cases more particles are moved, in the latter with more projections. Slow water is below
/// half of calm_speed: at the whole of it, waves would lose more of their amplitude (docs/decisions.md,
/// "Still water with levels").
template <class Selection>
void launch(FluidState& state, PartingColumns p, Selection select) {
  auto& levels = state.levels;
  const auto& k = state.parameters;
  const bool widely = k.gravity.strength * k.dt * k.dt < levels.rules.parts_widely * state.finest_support;
  levels.beside.resize(static_cast<std::size_t>(p.size()));
  levels.beside_count.resize(1);
  levels.beside_count.zero();
  for_each_team("list beside fresh", p.size(),
                ListBesideFresh<Selection>{.select = select,
                                           .ease = p.ease(),
                                           .velocity = p.velocity(),
                                           .slow = state.calm_for_events(0.5),
                                           .least = levels.rules.ease[0],
                                           .widely = widely,
                                           .neighbours = state.neighbours.view(),
                                           .slots = levels.beside.data(),
                                           .count = levels.beside_count.data()});
  const Listed<Selection> few{select, levels.beside.data(), levels.beside_count.data()};
  for (int round = 0; round < (widely ? levels.rules.wide_partings : levels.rules.partings); ++round) {
    constrain_density(state, p, few);
    displace(state, p, few);
  }
}

/// Separates all particles of weightless water by `weightless_partings` projections. If only the particles
/// near those that split or merged moved, they would compress the others, and the substep would turn this
/// compression into speed. Under gravity such water falls back; weightless water would fly apart.
void part_all(FluidState& state, PartingColumns p) {
  for (state.iteration = 0; state.iteration < state.levels.rules.weightless_partings; ++state.iteration) {
    constrain_density(state, p);
    displace(state, p);
  }
  state.iteration = 0;
}

/// Separates overlapping particles before the first substep moves them. At this time high density means
/// overlap; during a substep water is also compressed.
void run_parting(FluidState& state, PartingColumns p) {
  // Particles split and merge before a frame's first substep; in most frames of water at rest, none does.
  if (!state.levels.changed || state.substep > 0) return;
  go_back(state, p);
  p.zero<Column::Lambda>();
  if (state.parameters.weightless()) {
    part_all(state, p);
  } else {
    state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
  }
  go_on(state, p);
}

using EveryonesColumns = ColumnView<columns(Column::Predicted, Column::Neighbours, Column::Id),
                                    columns(Column::Predicted, Column::PredictedNext, Column::Position,
                                            Column::VelocityNext, Column::Lambda, Column::Density),
                                    columns(Column::Ease)>;

/// Removes compression that exists before a frame's first substep. Such compression is an error, caused for
/// example by an uneven start or by poured layers. If the substep removed the compression, it would become
/// speed: a lattice of 80 layers shot up at 12 m/s, and in the jet of the scene Faucet, which falls at 18
/// m/s, some particles were ejected at 35 m/s.
void stabilise(FluidState& state, EveryonesColumns p) {
  const int rounds = state.compressed ? 3 : state.jets.pouring ? 1 : 0;
  if (rounds == 0 || state.substep > 0) return;
  go_back(state, p);
  for (int round = 0; round < rounds; ++round) {
    press(state, p);
    constrain_density(state, p);
    displace(state, p);
  }
  go_on(state, p);
}

constexpr const char* source = "pre-stabilisation, Macklin et al. 2014, 4.4";

}  // namespace

Stage pre_stabilisation_stage() {
  return stage_of<stabilise>({.name = "pre-stabilisation",
                              .source = source,
                              .phase = Phase::Substep,
                              .called_for = [](const Demand& demand) -> std::string {
                                return demand.parameters.coarse_cycles > 0 ? "coarse cycles > 0" : "";
                              }});
}

Stage parting_stage() {
  return stage_of<run_parting>(
      {.name = "parting", .source = source, .phase = Phase::Substep, .called_for = if_levels});
}

}  // namespace sim::SIM_BACKEND
