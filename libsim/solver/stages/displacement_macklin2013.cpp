#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Delta p_i = w_i [lambda_i grad_i C_wall + (1 / rho_0) sum_j (m_j lambda_i + m_i lambda_j + s_ij) grad_i
/// W_ij], with s_ij of tensile_term(). The pair term is antisymmetric, so that sum m_i Delta p_i = 0 away
/// from walls.
template <bool OneLevel, bool Tensile, class Selection, class Boundary>
struct Displace {
  Selection select;
  const Vec4* predicted;
  const float* lambda;
  const int* id;
  Neighbours neighbours;
  Boundary walls;
  Vec4* next;
  /// positions at the substep's beginning; pushes between close particles move them too, by the share that
  /// counts as velocity, so that these pushes add none away from walls. nullptr: pushes move predicted
  /// positions only
  Vec4* start;
  TimeOfRest time;
  Guards* guards;
  int half;  ///< time of this pass, in half substeps since the frame's start (TroubleKey::of)
  float rest_density, tensile, wall_gap, momentum;
  float times;  ///< total factor on a step of this projection (times_taken())

#ifdef SIM_CUDA
  int lanes(int n) const { return team_wish_of_projections(n, OneLevel); }
#endif

  /// Adds particle j to the step; a separate function, so that the loop vectorises (SIM_LANES). own: lambda
  /// of the particle itself.
  SIM_FN void add(int j, Vec4 self, const PairKernel<OneLevel>& pair, float own, float& px, float& py,
                  float& pz, int& close) const {
    const Vec4 other = predicted[j];
    const Kernel kernel = pair.with(other.w);
    const float dx = self.x - other.x;
    const float dy = self.y - other.y;
    const float dz = self.z - other.z;
    const float r2 = dx * dx + dy * dy + dz * dz;
    const float least = coincident * kernel.h;
    close += r2 < too_close * too_close * kernel.h2;
    const Root root(at_least(r2, least * least));
    float push = pair.mass_ratio(other.w) * own + lambda[j];
    if constexpr (Tensile) push += tensile_term(kernel, r2, other.w);
    const float along = root.under(push * kernel.slope(root.r));
    px -= along * dx;
    py -= along * dy;
    pz -= along * dz;
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
    const float own = lambda[i];
    float px = 0;
    float py = 0;
    float pz = 0;
    int close = 0;
    const int count = neighbours.size(slot);
    const NeighbourRun run = neighbours.run(slot);
    SIM_LANES(px, py, pz, close)
    for (int k = team.rank(); k < count; k += Team::size) add(run[k], self, pair, own, px, py, pz, close);
    px = team.sum(px);
    py = team.sum(py);
    pz = team.sum(pz);
    close = team.sum(close);
    if (team.rank() > 0) return;
    Vec3 wall_gradient;
    walls.missing(xyz(self), self.w, wall_gradient);
    const float mass = mass_of(self.w, rest_density);
    Vec3 x = xyz(self) + (1 / rest_density) * Vec3{px, py, pz} + (own / mass) * wall_gradient;
    if (close) {
      const Parting parting = parted(slot, self, own);
      x += parting.step + parting.push;
      if (start) start[i] = with_w(xyz(start[i]) + (times / time(i)) * parting.push, start[i].w);
      if (parting.in_one_place) Witness{guards, id, half}.note(Trouble::Coincident, i);
    }
    // The momentum term repeats a share of the last projection's step: `next` still contains the positions
    // before that projection.
    if (momentum > 0) x += momentum * (xyz(self) - xyz(next[i]));
    if (walls.project(x, xyz(self), wall_gap * self.w / 2))
      atomic_add(&guards->wall_projected, std::uint64_t{1});
    next[i] = with_w(x, self.w);
  }

  /// w_i s_ij with s_ij = -tensile m_i m_j dbar^2 (W_ij / W(0.2 hbar))^4: the artificial pressure of Macklin
  /// and Mueller 2013, Eq. 13, with the units of m_j lambda_i.
  SIM_FN float tensile_term(const Kernel& kernel, float r2, float h_other) const {
    const float reference = kernel.density(0.04f * kernel.h2);
    const float q = kernel.density(r2) / reference;
    const float spacing = 0.5f * kernel.h;
    return -tensile * mass_of(h_other, rest_density) * spacing * spacing * q * q * q * q;
  }

  /// Displacements that separate particle i from particles that are too close. They are weighted by mass, so
  /// that the centre of mass of two such particles stays in place, if the substep solves both.
  struct Parting {
    /// from particles at the same position: adds velocity, and is never zero, even if the density alone would
    /// not separate the particles
    Vec3 step{0, 0, 0};
    Vec3 push{0, 0, 0};  ///< from other close particles: a tenth of the missing distance
    bool in_one_place = false;
  };
  SIM_FN Parting parted(int slot, Vec4 self, float own) const {
    const PairKernel<OneLevel> pair(self.w);
    Parting out;
    for (int k = 0; k < neighbours.size(slot); ++k) {
      const int j = neighbours(slot, k);
      const Vec4 other = predicted[j];
      const Kernel kernel = pair.with(other.w);
      const Vec3 offset = xyz(self) - xyz(other);
      const float r2 = dot(offset, offset);
      if (r2 >= too_close * too_close * kernel.h2) continue;
      const float least = coincident * kernel.h;
      const float ratio = pair.mass_ratio(other.w);
      if (r2 >= least * least) {
        const float r = sqrtf(r2);
        out.push += (0.1f * (too_close * kernel.h - r) * ratio / (1 + ratio) / r) * offset;
        continue;
      }
      // The offset has no direction, so the ids determine the step's direction.
      out.in_one_place = true;
      const float pressed = -(ratio * own + lambda[j]) * kernel.slope(least) / rest_density;
      const float apart = 0.05f * kernel.h * 2 * ratio / (1 + ratio);
      out.step += (pressed + apart) * parting_direction(id[select(slot)], id[j]);
    }
    return out;
  }
};

template <bool OneLevel, bool Tensile, class Selection, class Boundary>
void launch(FluidState& state, DisplacementView p, Vec4* start, Selection select, Boundary boundary) {
  const auto& k = state.parameters;
  for_each_team(
      few_in<Selection> ? "displacement beside fresh" : "displacement", p.size(),
      Displace<OneLevel, Tensile, Selection, Boundary>{.select = select,
                                                       .predicted = p.predicted(),
                                                       .lambda = p.lambda(),
                                                       .id = p.id(),
                                                       .neighbours = state.neighbours.view(),
                                                       .walls = boundary,
                                                       .next = p.predicted_next(),
                                                       .start = start,
                                                       .time = state.time_of_rest(),
                                                       .guards = state.guard(),
                                                       .half = 2 * state.substep,
                                                       .rest_density = k.rest_density,
                                                       .tensile = k.tensile,
                                                       .wall_gap = gap_of_kernels(state),
                                                       .momentum = state.iteration > 0 ? k.momentum : 0.0f,
                                                       .times = times_taken(k, state.iteration)});
}

template <bool OneLevel, bool Tensile, class Selection>
void launch(FluidState& state, DisplacementView p, Vec4* start, Selection select) {
  const auto& k = state.parameters;
  state.obstacles.exists() ? launch<OneLevel, Tensile>(state, p, start, select, state.solids())
                           : launch<OneLevel, Tensile>(state, p, start, select, state.walls);
  p.swap<Column::Predicted, Column::PredictedNext>();
  clamp_and_listen(state, p, p.predicted_next(), times_taken(k, state.iteration), false);
}

template <bool OneLevel, class Selection>
void launch(FluidState& state, DisplacementView p, Vec4* start, Selection select) {
  state.parameters.tensile > 0 ? launch<OneLevel, true>(state, p, start, select)
                               : launch<OneLevel, false>(state, p, start, select);
}

template <class Selection>
void launch(FluidState& state, DisplacementView p, Vec4* start, Selection select) {
  state.one_level ? launch<true>(state, p, start, select) : launch<false>(state, p, start, select);
}

void launch(FluidState& state, DisplacementView p, Vec4* start) {
  state.all_active ? launch(state, p, start, AllParticles{}) : launch(state, p, start, state.active());
}

using SubstepColumns =
    ColumnView<columns(Column::Predicted, Column::Lambda, Column::Neighbours, Column::Id, Column::Position),
               columns(Column::PredictedNext, Column::Predicted, Column::Position)>;
void run_displacement(FluidState& state, SubstepColumns p) { launch(state, p, p.position()); }

}  // namespace

void displace(FluidState& state, DisplacementView p) { launch(state, p, nullptr); }
void displace(FluidState& state, DisplacementView p, Listed<AllParticles> few) {
  launch<false>(state, p, nullptr, few);
}
void displace(FluidState& state, DisplacementView p, Listed<ActiveParticles> few) {
  launch<false>(state, p, nullptr, few);
}

Stage displacement_stage() {
  return stage_of<run_displacement>({.name = "displacement",
                                     .source = "Macklin and Mueller 2013, Eq. 12-14, mass-weighted",
                                     .phase = Phase::Iteration,
                                     .called_for = keeps_density});
}

}  // namespace sim::SIM_BACKEND
