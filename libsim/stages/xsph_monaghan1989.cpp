#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// What is done to pairs besides the viscosity: nothing, or, round fresh particles, a filter of the kick that
/// the substep gave them. After a split or a merge neighbours overlap; the projections part them, and how
/// fast they part is no motion of the fluid. Kicks are evened out among neighbours, so that the momentum
/// stays and what all of them feel, gravity and pressure, passes.
struct NoFilter {
  static constexpr bool filters = false;
};
struct KickFilter {
  static constexpr bool filters = true;
  const Vec4* kick;
  const float* ease;
  float strength;
  SIM_FN float share(int i, int j) const { return strength * (1 - fminf(ease[i], ease[j])); }
};

/// v_i += sum_j c_ij 2 m_j / (rho_i + rho_j) (v_j - v_i) W_ij: momentum-exact for mixed masses.
/// Particles that are not solved keep their velocity and count as at the rest density.
template <bool OneLevel, class Filter, class Selection>
struct Xsph {
  Selection select;
  const Vec4* position;
  const Vec4* velocity;
  const float* density;
  Neighbours neighbours;
  Vec4* next;
  float viscosity;
  Filter filter;

  template <class Team>
  SIM_FN void operator()(int slot, Team team) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) {
        next[~i] = velocity[~i];
        return;
      }
    }
    const Vec4 self = position[i];
    const PairKernel<OneLevel> pair(self.w);
    const Vec4 own = velocity[i];
    const float own_density = density[i];
    [[maybe_unused]] Vec4 own_kick{};
    if constexpr (Filter::filters) own_kick = filter.kick[i];
    float vx = 0;
    float vy = 0;
    float vz = 0;
    const int count = neighbours.size(slot);
    SIM_LANES(vx, vy, vz)
    for (int k = team.rank(); k < count; k += Team::size) {
      const int j = neighbours(slot, k);
      const Vec4 other = position[j];
      const Kernel kernel = pair.with(other.w);
      const float dx = self.x - other.x;
      const float dy = self.y - other.y;
      const float dz = self.z - other.z;
      const float weight =
          pair.mass_ratio(other.w) * kernel.density(dx * dx + dy * dy + dz * dz) / (own_density + density[j]);
      if constexpr (Filter::filters) {
        const float share = filter.share(i, j) * weight;
        const Vec4 kick = filter.kick[j];
        vx += share * (kick.x - own_kick.x);
        vy += share * (kick.y - own_kick.y);
        vz += share * (kick.z - own_kick.z);
      }
      const float flow = viscosity * weight;
      const Vec4 v = velocity[j];
      vx += flow * (v.x - own.x);
      vy += flow * (v.y - own.y);
      vz += flow * (v.z - own.z);
    }
    vx = team.sum(vx);
    vy = team.sum(vy);
    vz = team.sum(vz);
    if (team.rank() > 0) return;
    // Volume m_i / rho_0; densities are relative to rho_0.
    const float scale = 2 * mass_of(self.w, 1);
    next[i] = {own.x + scale * vx, own.y + scale * vy, own.z + scale * vz, 0};
  }
};

template <bool OneLevel, class Filter, class Selection>
void launch(FluidState& state, Filter filter, Selection select) {
  auto& p = state.particles;
  for_each_team("xsph", p.size(),
                Xsph<OneLevel, Filter, Selection>{
                    select, p.position.data(), p.velocity.data(), p.density.data(), state.neighbours.view(),
                    p.velocity_next.data(), state.parameters.viscosity, filter});
  p.velocity.swap(p.velocity_next);
}

template <bool OneLevel, class Filter>
void launch(FluidState& state, Filter filter) {
  state.all_active ? launch<OneLevel>(state, filter, AllParticles{})
                   : launch<OneLevel>(state, filter, state.active());
}

}  // namespace

Stage xsph_stage() {
  return {"xsph",
          "Monaghan 1989; Macklin and Mueller 2013, Eq. 17",
          Phase::SubstepEnd,
          columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours),
          columns(Column::VelocityNext, Column::Velocity),
          [](const Demand& demand) -> std::string {
            return demand.parameters.viscosity > 0 && !demand.levels ? "viscosity c > 0" : "";
          },
          [](FluidState& state) {
            state.one_level ? launch<true>(state, NoFilter{}) : launch<false>(state, NoFilter{});
          }};
}

Stage xsph_of_levels_stage() {
  return {
      "xsph of levels",
      "Monaghan 1989, with a filter of kicks round fresh particles",
      Phase::SubstepEnd,
      columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours, Column::Ease,
              Column::PredictedNext),
      columns(Column::VelocityNext, Column::Velocity),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      [](FluidState& state) {
        const auto& p = state.particles;
        launch<false>(state,
                      KickFilter{p.predicted_next.data(), p.ease.data(), state.levels.rules.kick_filter});
      }};
}

std::vector<Stage> all_stages() {
  return {nozzle_stage(),         frame_neighbours_stage(), gaze_targets_stage(),   saliency_stage(),
          saliency_parts_stage(), forced_targets_stage(),   graded_targets_stage(), split_and_merge_stage(),
          activation_stage(),     predict_stage(),          neighbours_stage(),     ease_stage(),
          parting_stage(),        coarse_pressure_stage(),  density_stage(),        eased_constraint_stage(),
          displacement_stage(),   velocity_stage(),         xsph_stage(),           xsph_of_levels_stage(),
          velocity_grid_stage(),  settling_stage()};
}

}  // namespace sim::SIM_BACKEND
