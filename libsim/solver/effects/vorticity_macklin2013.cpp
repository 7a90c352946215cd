/// Vorticity confinement: gives back the swirl that a method's own viscosity takes.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Less of a neighbourhood than this does not count as a whole one: spray has no curl.
constexpr float least_whole = 0.3f;
/// Where the slope of |omega| over h is less than this share of |omega| it has no direction.
constexpr float least_slope = 0.03f;
/// w of the curl of particles that are not solved.
constexpr float unknown = -1;

/// omega_i = sum_j V_j grad W_ij x (v_j - v_i) / s_i with poly6, and |omega_i| in w. s_i = 1/3 sum_j V_j
/// (x_j - x_i) grad W_ij is 1 inside and about a half at a plane surface or wall: what turns as a whole has
/// its omega inside, and within a seventh there, at every level and mix of levels.
template <bool OneLevel, class Selection>
struct Curl {
  Selection select;
  const Vec4* position;
  const Vec4* velocity;
  Neighbours neighbours;
  Vec4* curl;

  /// What particle j adds, over 6 V_i; see SIM_LANES.
  SIM_FN void add(int j, Vec4 self, Vec4 own, const PairKernel<OneLevel>& pair, float& x, float& y, float& z,
                  float& whole) const {
    const Vec4 other = position[j];
    const Vec4 v = velocity[j];
    const Kernel kernel = pair.with(other.w);
    const float dx = self.x - other.x;
    const float dy = self.y - other.y;
    const float dz = self.z - other.z;
    const float r2 = dx * dx + dy * dy + dz * dz;
    const float t = at_least(kernel.h2 - r2, 0.0f);
    const float along = pair.mass_ratio(other.w) * kernel.poly6 * t * t;
    const float ux = own.x - v.x;
    const float uy = own.y - v.y;
    const float uz = own.z - v.z;
    x += along * (dy * uz - dz * uy);
    y += along * (dz * ux - dx * uz);
    z += along * (dx * uy - dy * ux);
    whole += along * r2;
  }

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) {
        curl[~i] = {0, 0, 0, unknown};
        return;
      }
    }
    const Vec4 self = position[i];
    const Vec4 own = velocity[i];
    const PairKernel<OneLevel> pair(self.w);
    float x = 0;
    float y = 0;
    float z = 0;
    float whole = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    SIM_LANES(x, y, z, whole)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], self, own, pair, x, y, z, whole);
    x = team.sum(x);
    y = team.sum(y);
    z = team.sum(z);
    whole = team.sum(whole);
    if (team.rank() > 0) return;
    const float scale = 6 * mass_of(self.w, 1);
    const Vec3 out = (scale / at_least(scale / 3 * whole, least_whole)) * Vec3{x, y, z};
    curl[i] = with_w(out, length(out));
  }
};

/// dv / dt = c f N x omega with N = grad |omega| over its length: c is a speed, so that the force on a volume
/// does not depend on its particles. A Lamb-Oseen vortex gains c omega(r) round its axis. f feeds what turns
/// faster than `from` and no faster than `most`, so that still water stays still and swirl stays bounded.
/// Momentum is accounted (Change::Effects); spin is gained.
template <bool OneLevel, class Selection>
struct Confine {
  Selection select;
  const Vec4* position;
  const Vec4* curl;
  Neighbours neighbours;
  Vec4* velocity;
  float kick;  ///< c dt, m
  float from, most;

  /// What particle j adds to grad |omega|, over 6 V_i; see SIM_LANES.
  SIM_FN void add(int j, Vec4 self, float own, const PairKernel<OneLevel>& pair, float& x, float& y,
                  float& z) const {
    const Vec4 other = position[j];
    const Kernel kernel = pair.with(other.w);
    const float dx = self.x - other.x;
    const float dy = self.y - other.y;
    const float dz = self.z - other.z;
    const float t = at_least(kernel.h2 - (dx * dx + dy * dy + dz * dz), 0.0f);
    const float there = curl[j].w;
    float along = pair.mass_ratio(other.w) * kernel.poly6 * t * t * (there - own);
    if constexpr (!Selection::everyone) along = there < 0 ? 0.0f : along;
    x -= along * dx;
    y -= along * dy;
    z -= along * dz;
  }

  /// f: from 0 at `from` to 1 at twice that; from 1 at half of `most` to 0 there.
  SIM_FN float fed(float omega) const {
    const float rise = omega - from;
    const float begins = rise >= from ? 1.0f : at_least(rise, 0.0f) / from;
    return begins * at_most(at_least(2 - 2 * omega / most, 0.0f), 1.0f);
  }

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) return;
    }
    const Vec4 self = position[i];
    const Vec4 omega = curl[i];
    const PairKernel<OneLevel> pair(self.w);
    float x = 0;
    float y = 0;
    float z = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    SIM_LANES(x, y, z)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], self, omega.w, pair, x, y, z);
    x = team.sum(x);
    y = team.sum(y);
    z = team.sum(z);
    if (team.rank() > 0) return;
    const float share = omega.w > 0 ? fed(omega.w) : 0;
    if (!(share > 0)) return;
    const Vec3 slope = (6 * mass_of(self.w, 1) * self.w) * Vec3{x, y, z};
    const float least = least_slope * omega.w;
    const Vec3 n = (1 / sqrtf(dot(slope, slope) + least * least)) * slope;
    velocity[i] = with_w(xyz(velocity[i]) + (share * kick) * cross(n, xyz(omega)), 0);
  }
};

using CurlView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours), columns(Column::Normal)>;

template <bool OneLevel, class Selection>
void launch(FluidState& state, CurlView p, Selection select) {
  for_each_team("vorticity", p.size(),
                Curl<OneLevel, Selection>{.select = select,
                                          .position = p.position(),
                                          .velocity = p.velocity(),
                                          .neighbours = state.neighbours.view(),
                                          .curl = p.normal()});
}

using ConfineView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours, Column::Normal),
               columns(Column::Velocity)>;

template <bool OneLevel, class Selection>
void launch(FluidState& state, ConfineView p, Selection select) {
  const auto& k = state.parameters;
  for_each_team("confinement", p.size(),
                Confine<OneLevel, Selection>{.select = select,
                                             .position = p.position(),
                                             .curl = p.normal(),
                                             .neighbours = state.neighbours.view(),
                                             .velocity = p.velocity(),
                                             .kick = k.dt * k.effects[EffectKind::Vorticity],
                                             .from = k.effects[EffectOption::VorticityFrom],
                                             .most = k.effects[EffectOption::VorticityMost]});
}

template <class View, class Selection>
void launch_for(FluidState& state, View p, Selection select) {
  state.one_level ? launch<true>(state, p, select) : launch<false>(state, p, select);
}

template <class View>
void run(FluidState& state, View p) {
  state.all_active ? launch_for(state, p, AllParticles{}) : launch_for(state, p, state.active());
}

}  // namespace

std::vector<Stage> vorticity_stages() {
  return {stage_of<run<CurlView>>({.name = "vorticity", .phase = Phase::SubstepEnd}),
          stage_of<run<ConfineView>>({.name = "confinement", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
