/// The stages that set target levels (for tests, at narrow outlets, graded between neighbours), and the stage
/// that splits and merges.

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

/// A box around a narrow outlet, and the coarsest level whose particles fit through the outlet.
struct NarrowOpening {
  Vec3 low, high;
  int fits;
};

/// Limits targets near narrow openings to levels that fit through them.
struct FitOpenings {
  const Vec4* position;
  std::uint8_t* target;
  NarrowOpening openings[Walls::most_openings];
  int count;
  SIM_FN void operator()(int i) const {
    const Vec3 x = xyz(position[i]);
    for (int k = 0; k < count; ++k) {
      const NarrowOpening& o = openings[k];
      const bool near = x.x >= o.low.x && x.y >= o.low.y && x.z >= o.low.z && x.x <= o.high.x &&
                        x.y <= o.high.y && x.z <= o.high.z;
      if (near && target[i] > o.fits) target[i] = static_cast<std::uint8_t>(o.fits);
    }
  }
};

/// Minimum width of an opening through which a particle fits, in spacings of the particle.
constexpr float spacings_wide = 2;

void run_opening_targets(FluidState& state,
                         ColumnView<columns(Column::Position), columns(Column::Target)> p) {
  if (!state.levels.turns.due) return;
  FitOpenings fit{.position = p.position(), .target = p.target(), .openings = {}, .count = 0};
  const int coarsest = state.levels.rules.coarsest;
  const float reach = state.supports.h[coarsest];
  for (int k = 0; k < state.walls.opening_count; ++k) {
    const Opening& o = state.walls.openings[k];
    // Along the wall's normal the opening is unbounded, so the minimum is the opening's narrower side.
    const Vec3 size = o.high - o.low;
    const float narrow = at_most(at_most(size.x, size.y), size.z);
    int fits = coarsest;
    while (fits > 0 && narrow < spacings_wide * 0.499f * state.supports.h[fits]) --fits;
    if (fits == coarsest) continue;
    // Targets are limited within this distance of the opening, so that water has time to split on its way to
    // the opening.
    const float margin = narrow + reach;
    Vec3 low = o.low - Vec3{margin, margin, margin};
    Vec3 high = o.high + Vec3{margin, margin, margin};
    const Plane& wall = state.walls.planes[o.plane];
    const auto beside_wall = [&](float normal, float& from, float& to) {
      if (normal == 0) return;
      from = normal * wall.offset - margin;
      to = normal * wall.offset + margin;
    };
    beside_wall(wall.normal.x, low.x, high.x);
    beside_wall(wall.normal.y, low.y, high.y);
    beside_wall(wall.normal.z, low.z, high.z);
    fit.openings[fit.count++] = {low, high, fits};
  }
  if (fit.count > 0) for_each("fit openings", p.size(), fit);
}

}  // namespace

Stage opening_targets_stage() {
  return stage_of<run_opening_targets>({.name = "opening targets",
                                        .source = "particles of two spacings fit through an outlet",
                                        .phase = Phase::FrameStart,
                                        .called_for = [](const Demand& demand) -> std::string {
                                          return demand.levels && demand.narrow_outlets && !demand.settling
                                                     ? "an outlet is narrow for coarse particles"
                                                     : "";
                                        },
                                        .part = Part::Levels});
}

namespace {

/// Hysteresis: a particle of level l with a coarser target keeps l as target, unless N (1 - s) is at least
/// l + 1 + dead_band, with s the saliency and N the number of levels. For a particle at rest of level 1 or
/// coarser, calm_dead_band is added to the dead band.
struct Hold {
  const std::uint8_t* level;
  const float* saliency;
  std::uint8_t* target;
  const Vec4* velocity;
  LevelRest rest;
  float levels, dead_band, calm_dead_band;
  SIM_FN void operator()(int i) const {
    if (target[i] <= level[i]) return;
    const float wider = level[i] > 0 ? calm_dead_band * rest(velocity[i]) : 0;
    const float border = static_cast<float>(level[i] + 1) + dead_band + wider;
    if (levels * (1 - saliency[i]) < border) target[i] = level[i];
  }
};

/// Limits the target level l_i to min_j l_j + 1 over the neighbours j. One sweep propagates a limit by one
/// support radius.
struct Grade {
  const Vec4* position;
  const std::uint8_t* target;
  ParticleNeighbours neighbours;
  std::uint8_t* out;
  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const int wish = target[i] > 1 ? team.min(graded(i, team)) : target[i];  // no limit is below 1
    if (team.rank() == 0) out[i] = static_cast<std::uint8_t>(wish);
  }
  /// The limited target of particle i, from this lane's share of the neighbours.
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

/// Number of sweeps after which no target changes. A target is limited to 1 only by a neighbour's target of
/// 0, and no sweep makes a new 0, so that the first sweep sets all limits of 1. In the same way the second
/// sweep sets all limits of 2, which come from targets of 1. Larger limits change nothing, because targets
/// are at most 3.
constexpr int sweeps = most_levels - 2;

using GradedTargetsColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Level, Column::Target, Column::Neighbours),
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
                  .velocity = p.velocity(),
                  .rest = {state.calm_for_events(LevelRest::fades_at)},
                  .levels = static_cast<float>(rules.coarsest + 1),
                  .dead_band = rules.dead_band,
                  .calm_dead_band = rules.calm_dead_band});
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
                         .merges_pause = !state.activation.rules.within_frame,
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
