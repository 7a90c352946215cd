#include "libsim/levels/easing.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// rho_i = sum_j m_j W_ij, C_i = max(rho_i / rho_0 + missing - 1, 0) and
/// lambda_i = -C_i / (w_i |grad_i C_i|^2 + sum_j m_j |grad W_ij|^2 / rho_0^2 + epsilon_i), w = 1 / m.
/// `missing` is the share of the kernel behind walls and obstacles. Sums use mass ratios m_j / m_i: with V_i
/// = m_i / rho_0 the masses cancel except for one factor. A particle that is not solved has lambda = 0;
/// unless OthersYield, it does not contribute to the sum over j, as if its mass were infinite.
template <bool OneLevel, bool OthersYield, class Selection, class Boundary>
struct Density {
  Selection select;
  const Vec4* predicted;
  Neighbours neighbours;
  Boundary walls;
  const float* ease;  ///< share of its constraint that a particle enforces; nullptr = the whole constraint
  float* lambda;
  float* density;
  Guards* guards;
  float rest_density, relaxation;

#ifdef SIM_CUDA
  int lanes(int n) const { return team_wish_of_projections(n, OneLevel); }
#endif

  /// Adds particle j to the sums; a separate function, so that the loop vectorises (SIM_LANES).
  SIM_FN void add(int j, Vec4 self, const PairKernel<OneLevel>& pair, float& rho, float& gx, float& gy,
                  float& gz, float& squares, int& zero) const {
    const Vec4 other = predicted[j];
    const Kernel kernel = pair.with(other.w);
    const float ratio = pair.mass_ratio(other.w);
    const float dx = self.x - other.x;
    const float dy = self.y - other.y;
    const float dz = self.z - other.z;
    const float r2 = dx * dx + dy * dy + dz * dz;
    const float least = coincident * kernel.h;
    zero += r2 < least * least;
    const Root root(at_least(r2, least * least));
    const float slope = kernel.slope(root.r);
    const float along = root.under(ratio * slope);
    rho += ratio * kernel.density(r2);
    gx -= along * dx;
    gy -= along * dy;
    gz -= along * dz;
    if constexpr (OthersYield) {
      squares += ratio * slope * slope;
    } else {
      squares += select.moves(j) * ratio * slope * slope;
    }
  }

  template <class Team>
  SIM_FN void operator()(int turn, Team team) const {
    const int slot = select.slot(turn);
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) return;
    }
    const Vec4 self = predicted[i];
    const PairKernel<OneLevel> pair(self.w);
    float rho = 0;
    float gx = 0;
    float gy = 0;
    float gz = 0;
    float squares = 0;
    int zero = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    SIM_LANES(rho, gx, gy, gz, squares, zero)
    for (int k = team.rank(); k < count; k += Team::size)
      add(run[k], self, pair, rho, gx, gy, gz, squares, zero);
    rho = team.sum(rho) + Kernel(self.w).density(0);
    gx = team.sum(gx);
    gy = team.sum(gy);
    gz = team.sum(gz);
    squares = team.sum(squares);
    zero = team.sum(zero);
    if (team.rank() > 0) return;
    // Each coincident pair is counted twice, once for each of its particles.
    if (zero) atomic_add(&guards->coincident_pairs, static_cast<std::uint64_t>(zero));
    const float mass = mass_of(self.w, rest_density);
    const float volume = mass / rest_density;
    Vec3 wall_gradient;
    const float filled = volume * rho + walls.missing(xyz(self), self.w, wall_gradient);
    const Vec3 gradient = Vec3{volume * gx, volume * gy, volume * gz} + wall_gradient;
    const float spacing = 0.5f * self.w;
    const float softness = relaxation / (spacing * spacing);
    const float stiffness = dot(gradient, gradient) + volume * volume * squares + softness;
    const float whole = at_most(-mass * (filled - 1) / stiffness, 0.0f);
    lambda[i] = ease ? whole * Easing::share(ease[i], filled) : whole;
    density[i] = filled;
  }
};

template <bool OneLevel, bool OthersYield, class Selection, class Boundary>
void launch(FluidState& state, DensityView p, const float* ease, Selection select, Boundary boundary) {
  for_each_team(
      few_in<Selection> ? "density beside fresh" : "density", p.size(),
      Density<OneLevel, OthersYield, Selection, Boundary>{.select = select,
                                                          .predicted = p.predicted(),
                                                          .neighbours = state.neighbours.view(),
                                                          .walls = boundary,
                                                          .ease = ease,
                                                          .lambda = p.lambda(),
                                                          .density = p.density(),
                                                          .guards = state.guard(),
                                                          .rest_density = state.parameters.rest_density,
                                                          .relaxation = state.parameters.relaxation});
}

template <bool OneLevel, bool OthersYield, class Selection>
void launch(FluidState& state, DensityView p, const float* ease, Selection select) {
  state.obstacles.exists() ? launch<OneLevel, OthersYield>(state, p, ease, select, state.solids())
                           : launch<OneLevel, OthersYield>(state, p, ease, select, state.walls);
}

template <bool OthersYield, class Selection>
void launch(FluidState& state, DensityView p, const float* ease, Selection select) {
  state.one_level ? launch<true, OthersYield>(state, p, ease, select)
                  : launch<false, OthersYield>(state, p, ease, select);
}

void constrain(FluidState& state, DensityView p, const float* ease) {
  if (state.all_active) {
    launch<true>(state, p, ease, AllParticles{});
  } else if (state.activation.rules.others_yield) {
    launch<true>(state, p, ease, state.active());
  } else {
    launch<false>(state, p, ease, state.active());
  }
}

using EasedView = ColumnView<DensityView::reads, DensityView::writes, columns(Column::Ease)>;

/// While the water settles, all particles have one level and the column Ease is not written: each particle
/// then enforces the whole constraint.
void run_density(FluidState& state, EasedView p) {
  constrain(state, p, state.one_level ? nullptr : p.ease());
}

}  // namespace

void constrain_density(FluidState& state, DensityView p) { constrain(state, p, nullptr); }

void constrain_density(FluidState& state, DensityView p, EverySlot everyone) {
  launch<true>(state, p, nullptr, everyone);
}

void constrain_density(FluidState& state, DensityView p, Listed<AllParticles> few) {
  launch<true>(state, p, nullptr, few);
}
void constrain_density(FluidState& state, DensityView p, Listed<ActiveParticles> few) {
  launch<true>(state, p, nullptr, few);
}

Stage density_stage() {
  return stage_of<run_density>({.name = "density constraint",
                                .source = "Macklin and Mueller 2013, Eq. 1-11, mass-weighted and unilateral",
                                .phase = Phase::Iteration,
                                .called_for = keeps_density});
}

}  // namespace sim::SIM_BACKEND
