/// Target levels of tests, the limit to one level between neighbours, and splits and merges.

#include "libsim/levels/split_merge.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Force {
  const Vec4* position;
  std::uint8_t* target;
  TargetSphere sphere;
  int coarsest;
  SIM_FN void operator()(int i) const {
    const Vec3 offset = xyz(position[i]) - sphere.centre;
    const bool inside = dot(offset, offset) <= sphere.radius * sphere.radius;
    const int wish = inside ? sphere.inside : sphere.outside;
    target[i] = static_cast<std::uint8_t>(wish < coarsest ? wish : coarsest);
  }
};

using ForcedTargetsColumns = ColumnView<columns(Column::Position), columns(Column::Target)>;

void run_forced_targets(FluidState& state, ForcedTargetsColumns p) {
  for_each("force targets", p.size(),
           Force{p.position(), p.target(), state.levels.forced, state.levels.rules.coarsest});
}

}  // namespace

Stage forced_targets_stage() {
  return stage_of<run_forced_targets>({.name = "forced targets",
                                       .source = "a test's levels",
                                       .phase = Phase::FrameStart,
                                       .called_for = [](const Demand& demand) -> std::string {
                                         return demand.forced_targets ? "a test gives them" : "";
                                       },
                                       .part = Part::Levels});
}

namespace {

/// Keeps the level of particles that are not far enough beyond the border to a coarser one.
struct Hold {
  const std::uint8_t* level;
  const float* saliency;
  std::uint8_t* target;
  float levels, dead_band;
  SIM_FN void operator()(int i) const {
    if (target[i] <= level[i]) return;
    const float border = static_cast<float>(level[i] + 1) + dead_band;
    if (levels * (1 - saliency[i]) < border) target[i] = level[i];
  }
};

/// l_i <= min_j l_j + 1 over the neighbours: one sweep propagates by one support radius.
struct Grade {
  const Vec4* position;
  const std::uint8_t* target;
  ParticleNeighbours neighbours;
  std::uint8_t* out;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const int wish = target[i] > 1 ? team.min(graded(i, team)) : target[i];  // 0 and 1 are never too coarse
    if (team.rank() == 0) out[i] = static_cast<std::uint8_t>(wish);
  }
  /// Over this lane's neighbours.
  template <class Team>
  SIM_FN int graded(int i, Team team) const {
    int wish = target[i];
    const Vec4 self = position[i];
    const int size = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    for (int k = team.rank(); k < size && wish > 1; k += Team::size) {
      const int j = run[k];
      if (target[j] + 1 >= wish) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      if (dot(offset, offset) < h * h) wish = target[j] + 1;
    }
    return wish;
  }
};

/// A difference of three levels needs three sweeps.
constexpr int sweeps = 3;

using GradedTargetsColumns =
    ColumnView<columns(Column::Position, Column::Level, Column::Target, Column::Neighbours),
               columns(Column::Target), columns(Column::Saliency)>;

void run_graded_targets(FluidState& state, GradedTargetsColumns p) {
  if (!state.levels.turns.due) return;
  auto& graded = state.levels.graded;
  const auto& rules = state.levels.rules;
  if (rules.dead_band > 0 && p.has(Column::Saliency)) {
    for_each("hold levels", p.size(),
             Hold{.level = p.level(),
                  .saliency = p.saliency(),
                  .target = p.target(),
                  .levels = static_cast<float>(rules.coarsest + 1),
                  .dead_band = rules.dead_band});
  }
  if (!rules.graded) return;
  graded.reserve(static_cast<std::size_t>(p.capacity()));
  graded.resize(static_cast<std::size_t>(p.size()));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for_each_team("grade targets", p.size(),
                  Grade{p.position(), p.target(), state.particle_neighbours(), graded.data()});
    p.swap<Column::Target>(graded);
  }
}

}  // namespace

Stage graded_targets_stage() {
  return stage_of<run_graded_targets>({.name = "graded targets",
                                       .source = "neighbours differ by one level at most",
                                       .phase = Phase::FrameStart,
                                       .called_for = if_levels,
                                       .part = Part::Levels});
}

namespace {

void run_split_and_merge(FluidState& state, LevelView p) {
  if (!state.levels.turns.due) return grow_older(state.levels, p);
  const LevelFluid fluid{.particles = p,
                         .neighbours = state.particle_neighbours(),
                         .last_active = state.last_active(),
                         .solids = state.solids(),
                         .supports = state.supports,
                         .rest_density = state.parameters.rest_density,
                         .wall_gap = state.parameters.wall_gap};
  split_and_merge(state.levels, fluid, state.particles);
  if (state.levels.changed) state.lists_hold = false;
}

}  // namespace

Stage split_and_merge_stage() {
  return stage_of<run_split_and_merge>({.name = "split and merge",
                                        .source = "Algorithms 1 and 2",
                                        .phase = Phase::FrameStart,
                                        .called_for = if_levels,
                                        .part = Part::Levels,
                                        .changes = Change::Levels});
}

}  // namespace sim::SIM_BACKEND
