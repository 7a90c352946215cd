/// Random steps that prevent a very viscous fluid of equally large particles from locking in a lattice.

#include <cmath>

#include "libsim/particles/random.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Under pressure particles of one size form a lattice, which carries shear until it yields: a fluid so
/// viscous that its particles do not jitter would stop on a slope. So each particle inside the fluid takes a
/// random step, and the next projections correct the density. Velocities do not change, and so momentum is
/// conserved.
constexpr float loosening = 0.04f;  ///< maximum step along each axis, in spacings
/// Largest nu dt / d^2, with the viscosity nu and the spacing d, at which steps have the full length
/// `loosening`. A thicker fluid needs shorter steps: its flow per substep decreases as 1 / nu, and steps
/// loosen the lattice in proportion to their square. Longer steps would make the fluid swell faster than it
/// flows (docs/decisions.md).
constexpr float loosened_in_full = 2;
struct Loosen {
  Vec4* position;
  const float* density;
  const int* id;
  float widest;  ///< largest support of particles on which the effect acts, m
  float less;    ///< limit of the step of thick fluid along each axis, divided by h^2, 1/m

  SIM_FN void operator()(int i) const {
    if (density[i] < inside) return;
    const Vec4 at = position[i];
    if (at.w > widest) return;
    const Vec3 step{along(i, 0, at.x), along(i, 1, at.y), along(i, 2, at.z)};
    position[i] = with_w(xyz(at) + at_most(loosening / 2, less * at.w) * at.w * step, at.w);
  }
  /// A random number, uniform in [-1, 1), from a hash. The hash contains the position instead of the time, so
  /// that a run resumed from a saved state takes the same steps.
  SIM_FN float along(int i, std::uint32_t axis, float place) const {
    const auto moment = static_cast<std::uint32_t>(static_cast<std::int64_t>(place * fine));
    return 2 * uniform_of(random_bits(static_cast<std::uint32_t>(id[i]), moment, axis)) - 1;
  }
  static constexpr float fine = 1048576;  ///< 1/m: the hash truncates positions to multiples of 1 / fine
  /// Minimum density inside the fluid, as a share of rho_0. Particles of lower density are at the surface and
  /// do not move.
  static constexpr float inside = 0.95f;
};

using LoosenView =
    ColumnView<columns(Column::Position, Column::Density, Column::Id), columns(Column::Position)>;

/// Acts after the last substep of a frame: the projections of the next frame's first substep undo most steps,
/// and its other substeps damp the speed that this leaves, so that fluid at rest is calm between frames. Does
/// nothing in weightless fluid, which has no pressure, and with mixed particle sizes, which form no lattice.
void run_loosen(FluidState& state, LoosenView p) {
  const auto& k = state.parameters;
  if (!state.one_level || k.weightless() || state.substep + 1 < k.substeps) return;
  const float diffusion = k.dt * k.effects[EffectKind::Viscosity];
  for_each("loosen", p.size(),
           Loosen{.position = p.position(),
                  .density = p.density(),
                  .id = p.id(),
                  .widest = state.widest_support(EffectOption::ViscosityCoarsest),
                  .less = loosening / 4 * std::sqrt(loosened_in_full / diffusion)});
}

}  // namespace

Stage loosening_stage() {
  return stage_of<run_loosen>({.name = "loosening of the lattice", .phase = Phase::SubstepEnd});
}

}  // namespace sim::SIM_BACKEND
