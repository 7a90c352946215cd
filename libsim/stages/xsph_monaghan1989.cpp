#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Which pairs have the strong viscosity: those with a particle just made by a split or a merge. Its place is
/// a guess, and what the projections correct there is no motion of the fluid.
struct NoFresh {
  SIM_FN float operator()(int, int, float viscosity) const { return viscosity; }
};
struct FreshPairs {
  const std::uint8_t* age;
  float strong;
  int frames;
  SIM_FN float operator()(int i, int j, float viscosity) const {
    return age[i] < frames || age[j] < frames ? strong : viscosity;
  }
};

/// v_i += sum_j c_ij 2 m_j / (rho_i + rho_j) (v_j - v_i) W_ij: momentum-exact for mixed masses.
/// Particles that are not solved keep their velocity and count as at the rest density.
template <bool OneLevel, class Fresh, class Selection>
struct Xsph {
  Selection select;
  const Vec4* position;
  const Vec4* velocity;
  const float* density;
  Neighbours neighbours;
  Vec4* next;
  float viscosity;
  Fresh fresh;

  SIM_FN void operator()(int slot) const {
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
    float vx = 0;
    float vy = 0;
    float vz = 0;
    const int count = neighbours.size(slot);
    SIM_LANES(vx, vy, vz)
    for (int k = 0; k < count; ++k) {
      const int j = neighbours(slot, k);
      const Vec4 other = position[j];
      const Kernel kernel = pair.with(other.w);
      const float dx = self.x - other.x;
      const float dy = self.y - other.y;
      const float dz = self.z - other.z;
      const float weight = fresh(i, j, viscosity) * pair.mass_ratio(other.w) *
                           kernel.density(dx * dx + dy * dy + dz * dz) / (own_density + density[j]);
      const Vec4 v = velocity[j];
      vx += weight * (v.x - own.x);
      vy += weight * (v.y - own.y);
      vz += weight * (v.z - own.z);
    }
    // Volume m_i / rho_0; densities are relative to rho_0.
    const float scale = 2 * mass_of(self.w, 1);
    next[i] = {own.x + scale * vx, own.y + scale * vy, own.z + scale * vz, 0};
  }
};

template <bool OneLevel, class Fresh, class Selection>
void launch(FluidState& state, Fresh fresh, Selection select) {
  auto& p = state.particles;
  for_each("xsph", p.size(),
           Xsph<OneLevel, Fresh, Selection>{select, p.position.data(), p.velocity.data(), p.density.data(),
                                            state.neighbours.view(), p.velocity_next.data(),
                                            state.parameters.viscosity, fresh});
  p.velocity.swap(p.velocity_next);
}

template <bool OneLevel, class Fresh>
void launch(FluidState& state, Fresh fresh) {
  state.all_active ? launch<OneLevel>(state, fresh, AllParticles{})
                   : launch<OneLevel>(state, fresh, state.active());
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
            state.one_level ? launch<true>(state, NoFresh{}) : launch<false>(state, NoFresh{});
          }};
}

Stage xsph_of_levels_stage() {
  return {
      "xsph of levels",
      "Monaghan 1989, stronger round fresh particles",
      Phase::SubstepEnd,
      columns(Column::Position, Column::Velocity, Column::Density, Column::Neighbours, Column::Age),
      columns(Column::VelocityNext, Column::Velocity),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      [](FluidState& state) {
        const auto& rules = state.levels.rules;
        launch<false>(state,
                      FreshPairs{state.particles.age.data(), rules.fresh_viscosity, rules.fresh_frames});
      }};
}

std::vector<Stage> all_stages() {
  return {nozzle_stage(),          frame_neighbours_stage(), gaze_targets_stage(),
          saliency_stage(),        saliency_parts_stage(),   forced_targets_stage(),
          graded_targets_stage(),  split_and_merge_stage(),  activation_stage(),
          predict_stage(),         neighbours_stage(),       ease_stage(),
          coarse_pressure_stage(), density_stage(),          eased_constraint_stage(),
          displacement_stage(),    velocity_stage(),         xsph_stage(),
          xsph_of_levels_stage(),  velocity_grid_stage(),    settling_stage()};
}

}  // namespace sim::SIM_BACKEND
