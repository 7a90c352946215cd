#include <algorithm>
#include <cmath>

#include "libsim/particles/calm.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// The average of velocities over neighbours and over time. It tells motion of the water from the jitter of
/// single particles. Both have the same speed in a wave with short substeps, but jitter has no mean.
struct DriftAverage {
  const Vec4* drift;
  Vec4* next;
  float mixed;     ///< share of the difference to neighbours that one substep removes from the average
  float followed;  ///< share of the difference to the velocity that one substep removes
  float kept;      ///< share of the largest recent square that remains after one substep
  /// From this squared speed on, m2/s2, a particle's average does not mix with those of its neighbours. Such
  /// fast water is not still in any case, and the sum over neighbours takes time.
  float fast;

  /// The average after a substep. mean: the average before, mixed with that of neighbours. An average that is
  /// not finite begins anew at 0, else it would spread to all water.
  SIM_FN Vec4 after(Vec4 mean, Vec3 velocity) const {
    const Vec3 u = xyz(mean) + followed * (velocity - xyz(mean));
    const float square = dot(u, u);
    if (!(square + mean.w < 1e30f)) return {0, 0, 0, 0};
    return with_w(u, at_least(square, kept * mean.w));
  }
};

/// What the viscosity pass does besides viscosity. Without levels it does nothing more (NoFilter), except in
/// short substeps, where it also updates the average motion (AverageOnly). docs/decisions.md, "Still water of
/// one size" and "Still water in short substeps", describes how that water comes to rest.
///
/// With levels it also filters velocities (RestingWater). A new particle of a split or a merge overlaps its
/// neighbours. The projections push them apart, and that push gives them a speed that water would not have.
/// So the pass averages velocity changes near new particles over neighbours. The average conserves momentum,
/// and keeps changes that all particles share, such as those by gravity and pressure. Splits and merges also
/// raise the water's surface a little. The water then sinks for a second or two, and gains speed. More
/// viscosity where water is at rest removes that speed. Where water moved before, the filter is weaker and
/// the viscosity is the usual one, as the water would lose energy.
struct NoFilter {
  static constexpr bool filters = false, averages = false;
};
struct AverageOnly {
  static constexpr bool filters = false, averages = true;
  DriftAverage average;
};
struct RestingWater {
  static constexpr bool filters = true, averages = true;
  const Vec4* kick;
  const float* ease;
  float strength;
  Calm calm;
  /// Share of the filter that moving water gets. With 1, dam breaks lose 4 % of their energy; with 0, splits
  /// and merges move a deep pool faster than the limit of rest. If no water counts as at rest, without
  /// gravity or with Readings::calm_speed 0, the share is 1.
  float in_motion;
  float viscosity;  ///< additional viscosity of water at rest, as a multiple of the fluid's viscosity
  /// a^2 - 1 if `calm` has a times the limit speed of calm_speed: the viscosity falls to 0 at this speed
  float steeper;
  DriftAverage average;

  /// Degree to which the particle was at rest before the substep's velocity change (kick).
  SIM_FN float rest(Vec4 v, int i) const {
    const Vec4 k = kick[i];
    return calm(v.x - k.x, v.y - k.y, v.z - k.z);
  }
  SIM_FN float share(int i, int j, float resting) const {
    return at_least(resting, in_motion) * strength * (1 - at_most(ease[i], ease[j]));
  }
};

/// Upper bound for the share of a pair's velocity difference that one substep removes, for stability of the
/// explicit step.
constexpr float most_share = 0.5f;

/// v_i += sum_j c_ij 2 m_j / (rho_i + rho_j) (v_j - v_i) W_ij: conserves momentum exactly, also for mixed
/// masses. The second moment of poly6 is h^2 / 11 along each axis, so that one substep diffuses velocity by c
/// h^2 / 22 and c_ij = 22 nu dt / h_ij^2 is the kinematic viscosity nu at every size and time step. Unsolved
/// particles keep their velocity and count as having the rest density.
template <bool OneLevel, class Filter, class Selection>
struct Xsph {
  Selection select;
  const Vec4* position;
  const Vec4* velocity;  ///< the fourth component is the degree of rest: particles at rest take the mean
                         ///< velocity of their neighbours
  const float* density;
  Neighbours neighbours;
  Vec4* next;
  float spread;  ///< 22 nu dt, m2, with the kinematic viscosity nu
  TimeOfRest time;
  Filter filter;

  /// The particle whose neighbours are summed.
  struct Self {
    int i;
    Vec4 at, velocity;
    float density;
    float still;  ///< degree of rest, 0 to 1
    PairKernel<OneLevel> pair;
    float spread;    ///< 22 nu times the time since it was last solved, m2
    Vec4 kick{};     ///< velocity change in the substep; only with a filter
    float rest = 0;  ///< degree of rest before this change; only with a filter
    Vec4 drift{};    ///< only with an average
  };

  /// Adds particle j to the change of velocity and, if Mixes, to the change d of the average Drift; a
  /// separate function, so that the loop vectorises (SIM_LANES).
  template <bool Mixes>
  SIM_FN void add(int j, const Self& me, float& vx, float& vy, float& vz, float& dx, float& dy, float& dz,
                  float& dw) const {
    const Vec4 other = position[j];
    const Kernel kernel = me.pair.with(other.w);
    const float x = me.at.x - other.x;
    const float y = me.at.y - other.y;
    const float z = me.at.z - other.z;
    const float weight = quotient(me.pair.mass_ratio(other.w) * kernel.density(x * x + y * y + z * z),
                                  me.density + density[j]);
    const Vec4 v = velocity[j];
    float thicker = 1;
    if constexpr (Filter::filters) {
      const float resting = at_most(me.rest, filter.rest(v, j));
      thicker += filter.viscosity * at_least(resting - filter.steeper * (1 - resting), 0.0f);
      const float share = filter.share(me.i, j, resting) * weight;
      const Vec4 kick = filter.kick[j];
      vx += share * (kick.x - me.kick.x);
      vy += share * (kick.y - me.kick.y);
      vz += share * (kick.z - me.kick.z);
    }
    if constexpr (Mixes) {
      const Vec4 drift = filter.average.drift[j];
      dx += weight * (drift.x - me.drift.x);
      dy += weight * (drift.y - me.drift.y);
      dz += weight * (drift.z - me.drift.z);
      dw += weight * (drift.w - me.drift.w);
    }
    const float viscous = at_most(thicker * me.spread * reciprocal(kernel.h2), most_share);
    const float calmed = at_most(me.still, v.w);
    const float flow = (viscous + calmed * (1 - viscous)) * weight;
    vx += flow * (v.x - me.velocity.x);
    vy += flow * (v.y - me.velocity.y);
    vz += flow * (v.z - me.velocity.z);
  }

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) {
        next[~i] = with_w(xyz(velocity[~i]), 0);
        if constexpr (Filter::averages) filter.average.next[~i] = filter.average.drift[~i];
        return;
      }
    }
    const Vec4 own = velocity[i];
    Self me{i, position[i], own, density[i], own.w, PairKernel<OneLevel>(position[i].w), spread * time(i)};
    if constexpr (Filter::filters) {
      me.kick = filter.kick[i];
      me.rest = filter.rest(own, i);
    }
    if constexpr (Filter::averages) me.drift = filter.average.drift[i];
    float vx = 0;
    float vy = 0;
    float vz = 0;
    float dx = 0;
    float dy = 0;
    float dz = 0;
    float dw = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    bool mixes = false;
    if constexpr (Filter::averages) {
      mixes = me.drift.w < filter.average.fast;
      if (mixes) {
        SIM_LANES(vx, vy, vz, dx, dy, dz, dw)
        for (int k = team.rank(); k < count; k += Team::size)
          add<true>(run[k], me, vx, vy, vz, dx, dy, dz, dw);
        dx = team.sum(dx);
        dy = team.sum(dy);
        dz = team.sum(dz);
        dw = team.sum(dw);
      }
    }
    if (!mixes) {
      SIM_LANES(vx, vy, vz)
      for (int k = team.rank(); k < count; k += Team::size)
        add<false>(run[k], me, vx, vy, vz, dx, dy, dz, dw);
    }
    vx = team.sum(vx);
    vy = team.sum(vy);
    vz = team.sum(vz);
    if (team.rank() > 0) return;
    // Volume m_i / rho_0; densities are relative to rho_0.
    const float scale = 2 * mass_of(me.at.w, 1);
    next[i] = {own.x + scale * vx, own.y + scale * vy, own.z + scale * vz, 0};
    if constexpr (Filter::averages) {
      const DriftAverage& average = filter.average;
      const float mixed = average.mixed * scale;
      const Vec4 was = me.drift;
      average.next[i] = average.after(
          {was.x + mixed * dx, was.y + mixed * dy, was.z + mixed * dz, was.w + mixed * dw}, xyz(next[i]));
    }
  }
};

using XsphColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours),
               columns(Column::VelocityNext, Column::Velocity)>;

template <bool OneLevel, class Filter, class Selection>
void launch(FluidState& state, XsphColumns p, Filter filter, Selection select) {
  const auto& k = state.parameters;
  for_each_team("xsph", p.size(),
                Xsph<OneLevel, Filter, Selection>{.select = select,
                                                  .position = p.position(),
                                                  .velocity = p.velocity(),
                                                  .density = p.density(),
                                                  .neighbours = state.neighbours.view(),
                                                  .next = p.velocity_next(),
                                                  .spread = 22 * k.viscosity * k.dt,
                                                  .time = state.time_of_rest(),
                                                  .filter = filter});
  p.swap<Column::Velocity, Column::VelocityNext>();
}

template <bool OneLevel, class Filter>
void launch(FluidState& state, XsphColumns p, Filter filter) {
  state.all_active ? launch<OneLevel>(state, p, filter, AllParticles{})
                   : launch<OneLevel>(state, p, filter, state.active());
}

void run_xsph(FluidState& state, XsphColumns p) {
  state.one_level ? launch<true>(state, p, NoFilter{}) : launch<false>(state, p, NoFilter{});
}

using AverageView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours,
                       Column::Drift),
               columns(Column::VelocityNext, Column::Velocity, Column::Drift, Column::Normal)>;
using LevelsView = ColumnView<columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours,
                                      Column::Ease, Column::PredictedNext, Column::Drift),
                              columns(Column::VelocityNext, Column::Velocity, Column::Drift, Column::Normal)>;

/// Time scales of the average Drift, in sqrt(d / g) with the smallest spacing d of the run: the average
/// follows the velocity within `follow`; a largest square fades within `keep`, so that a wave still counts as
/// moving when it turns; within `mix` the average of one place spreads to its neighbours (docs/decisions.md,
/// "Boiling and waves").
struct DriftTimes {
  static constexpr double follow = 2.5, keep = 12, mix = 0.05;
};

/// Speed from which an average does not mix with its neighbours', in limit speeds of water at rest.
constexpr double fast_from = 4;

/// The share dt / time of a substep, at most 1; 0 without gravity, where no water counts as at rest.
float share_of(const FluidState& state, double time) {
  const double g = static_cast<double>(state.parameters.gravity.strength);
  if (!(g > 0)) return 0;
  const double unit = std::sqrt(static_cast<double>(state.smallest_support()) / 2 / g);
  return static_cast<float>(std::min(1.0, static_cast<double>(state.parameters.dt) / (time * unit)));
}

DriftAverage average_of(const FluidState& state, AverageView p) {
  const Calm fast = state.drift_calm(fast_from);
  return {.drift = p.drift(),
          .next = p.normal(),
          .mixed = share_of(state, DriftTimes::mix),
          .followed = share_of(state, DriftTimes::follow),
          .kept = 1 - share_of(state, DriftTimes::keep),
          .fast = fast.most > 0 ? 1 / fast.inverse_square : 0};
}

void run_average(FluidState& state, AverageView p) {
  const AverageOnly filter{average_of(state, p)};
  state.one_level ? launch<true>(state, p, filter) : launch<false>(state, p, filter);
  p.swap<Column::Drift, Column::Normal>();
}

void run_levels(FluidState& state, LevelsView p) {
  const auto& rules = state.levels.rules;
  const Calm calm = state.calm_for_events(1);
  launch<false>(state, p,
                RestingWater{.kick = p.predicted_next(),
                             .ease = p.ease(),
                             .strength = rules.kick_filter,
                             .calm = calm,
                             .in_motion = calm.most > 0 ? 0.4f : 1,
                             .viscosity = rules.calm_viscosity,
                             .steeper = static_cast<float>(std::min(4.0, state.shortness()) - 1),
                             .average = average_of(state, p)});
  p.swap<Column::Drift, Column::Normal>();
}

}  // namespace

Stage xsph_stage() {
  return stage_of<run_xsph>({.name = "xsph",
                             .source = "Monaghan 1989; Macklin and Mueller 2013, Eq. 17",
                             .phase = Phase::SubstepEnd,
                             .called_for = [](const Demand& demand) -> std::string {
                               const SolverParameters& k = demand.parameters;
                               if (demand.levels || demand.rests_by_drift) return "";
                               if (k.viscosity > 0) return "viscosity > 0";
                               return k.still_speed > 0 && k.gravity.strength > 0
                                          ? "gravity: water can be still"
                                          : "";
                             },
                             .changes = Change::Viscosity});
}

Stage xsph_of_short_steps_stage() {
  return stage_of<run_average>({.name = "xsph of short steps",
                                .source = "Monaghan 1989, with the average by which water is at rest",
                                .phase = Phase::SubstepEnd,
                                .called_for = [](const Demand& demand) -> std::string {
                                  return demand.rests_by_drift && !demand.levels
                                             ? "short substeps: jitter is faster than waves"
                                             : "";
                                },
                                .changes = Change::Viscosity});
}

Stage xsph_of_levels_stage() {
  return stage_of<run_levels>(
      {.name = "xsph of levels",
       .source = "Monaghan 1989, with a filter of kicks and more viscosity where water rests",
       .phase = Phase::SubstepEnd,
       .called_for = if_levels,
       .changes = Change::Viscosity});
}

}  // namespace sim::SIM_BACKEND
