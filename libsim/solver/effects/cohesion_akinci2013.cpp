/// Surface tension: an attraction between pairs, and a smoothing of the surface. As published, the attraction
/// also acts inside the water, where the resulting pressure makes particles stick (docs/decisions.md). Here
/// both terms come from energies that are constant inside the water, and so exert no force there.

#include "libsim/solver/effects/loops/surface_normals.hpp"
#include "libsim/solver/effects/surface_energy.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// m_i dv_i / dt = sigma sum_j V_i V_j [pull / hbar (s_i + s_j) grad W_ij
///                                     - smoothing grad grad W_ij (n_i - n_j)],
/// the forces of the energies of missing density and of |n|^2, with n the surface normal and s = skin(rho /
/// rho_0). Both are antisymmetric, so that momentum is conserved. V is a volume, hbar the mean support of a
/// pair. The force of a pair is proportional to the tension sigma times hbar, and the tension of a surface is
/// sigma per length at every particle size. Pairs with particles too
/// coarse for the effect are skipped.
template <bool OneLevel>
struct Cohesion {
  const Vec4* position;
  const float* density;
  const Vec4* normal;
  Neighbours neighbours;
  Vec4* velocity;
  float strength;  ///< dt sigma / rho_0, m3/s
  float widest;    ///< largest support of particles on which the effect acts, m

  struct Self {
    Vec4 at;
    Vec4 normal;
    float skin;
    PairKernel<OneLevel> pair;
  };

  /// Adds the velocity change by particle j, divided by 6 V_i and by `strength`. A separate function, so that
  /// the loop vectorises (SIM_LANES).
  SIM_FN void add(int j, const Self& me, float& vx, float& vy, float& vz) const {
    const Vec4 other = position[j];
    const Kernel kernel = me.pair.with(other.w);
    const float dx = me.at.x - other.x;
    const float dy = me.at.y - other.y;
    const float dz = me.at.z - other.z;
    const float t = at_least(kernel.h2 - (dx * dx + dy * dy + dz * dz), 0.0f);
    float weight = me.pair.mass_ratio(other.w) * kernel.poly6 * t;
    if constexpr (!OneLevel) weight = other.w <= widest ? weight : 0.0f;
    const float skins = me.skin + skin(density[j]);
    const Vec4 n = normal[j];
    const float even = smoothing_strength * weight;
    const float ux = me.normal.x - n.x;
    const float uy = me.normal.y - n.y;
    const float uz = me.normal.z - n.z;
    // grad W = -6 w t x, grad grad W = -6 w t 1 + 24 w x x, with w = poly6 t.
    const float along =
        pull_strength * reciprocal(kernel.h) * skins * weight * t + 4 * even * (ux * dx + uy * dy + uz * dz);
    vx -= along * dx - even * t * ux;
    vy -= along * dy - even * t * uy;
    vz -= along * dz - even * t * uz;
  }

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
    const Self me{at, normal[i], skin(density[i]), PairKernel<OneLevel>(at.w)};
    float vx = 0;
    float vy = 0;
    float vz = 0;
    const int count = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    SIM_LANES(vx, vy, vz)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], me, vx, vy, vz);
    vx = team.sum(vx);
    vy = team.sum(vy);
    vz = team.sum(vz);
    if (team.rank() > 0) return;
    const float scale = 6 * mass_of(at.w, 1) * strength;
    velocity[i] = with_w(xyz(velocity[i]) + scale * Vec3{vx, vy, vz}, 0);
  }
};

using CohesionView = ColumnView<columns(Column::Position, Column::Density, Column::Neighbours, Column::Normal,
                                        Column::Velocity),
                                columns(Column::Velocity)>;

template <bool OneLevel>
void launch(FluidState& state, CohesionView p) {
  const auto& k = state.parameters;
  for_each_team("cohesion", p.size(),
                Cohesion<OneLevel>{.position = p.position(),
                                   .density = p.density(),
                                   .normal = p.normal(),
                                   .neighbours = state.neighbours.view(),
                                   .velocity = p.velocity(),
                                   .strength = k.dt * k.effects[EffectKind::Cohesion] / k.rest_density,
                                   .widest = state.widest_support(EffectOption::CohesionCoarsest)});
}

void find_normals(FluidState& state, NormalView p) {
  with_surface_normals(state, p, [&](auto normals) { run_pair_loop("surface normals", state, p, normals); });
}

void pull(FluidState& state, CohesionView p) {
  state.one_level ? launch<true>(state, p) : launch<false>(state, p);
}

}  // namespace

std::vector<Stage> cohesion_stages() {
  return {stage_of<find_normals>(
              {.name = "surface normals", .phase = Phase::SubstepEnd, .loop = SharedTerm::SurfaceNormals}),
          stage_of<pull>({.name = "cohesion", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
