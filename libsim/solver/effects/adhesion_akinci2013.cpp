/// Adhesion: walls pull at water near them.

#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Share of the work of adhesion that the pull gives: calibrated by the contact angles of drops of level 0
/// (docs/solver_notes.md). The rest comes of the walls, which stand for the water that is missing behind
/// them.
constexpr float pull_share = 0.17f;

/// The printed pull of samples on a wall, A(q) = (-4 q^2 + 6 q - 2)^(1/4) for 1/2 < q < 1, summed over a
/// whole plane at the distance s: g(q) = q int_q^1 A, along the normal. dv = -dt W / (rho_0 h^2) g(s / h) / G
/// with G = int_0^1 q g(q) dq, so that taking a face of water off the wall costs the work w = pull_share W,
/// whatever its particles.
struct Adhesion {
  const Vec4* position;
  Walls walls;
  Vec4* velocity;
  float strength;  ///< dt w / rho_0, m3/s
  float whole;     ///< int_1/2^1 A
  float per_g;     ///< 1 / G

  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    Vec3 v = xyz(velocity[i]);
    for (int k = 0; k < walls.count; ++k) {
      const float q = walls.distance_in_h(k, xyz(at), at.w);
      if (q < 1) v += -(strength * per_g * pull(q) / (at.w * at.w)) * walls.planes[k].normal;
    }
    velocity[i] = with_w(v, 0);
  }

  /// With 4 q - 3 = sin t, A dq = cos^(3/2) t dt / (4 sqrt 2): Simpson's rule over t.
  SIM_FN float pull(float q) const {
    if (q <= 0.5f) return q * whole;
    return q * beyond(q);
  }
  SIM_FN static float beyond(float q) {
    constexpr int steps = 8;
    const float from = asinf(at_most(4 * q - 3, 1.0f));
    const float step = (pi / 2 - from) / steps;
    float sum = 0;
    for (int k = 0; k < steps; ++k) {  // the last is 0
      const float c = at_least(cosf(from + step * static_cast<float>(k)), 0.0f);
      sum += (k == 0 ? 1.0f : k % 2 ? 4.0f : 2.0f) * c * sqrtf(c);
    }
    return sum * step / 3 * 0.17677670f;
  }
};

using Columns = ColumnView<columns(Column::Position, Column::Velocity), columns(Column::Velocity)>;

void run(FluidState& state, Columns p) {
  // int_1/2^1 A and G in closed form: with B(x, y) Euler's beta function, A's moments about 3/4 are
  // B(1/2, 5/4) / (4 sqrt 2) and B(3/2, 5/4) / (64 sqrt 2); G = int A q^3 / 3.
  const double whole = std::beta(0.5, 1.25) / (4 * std::sqrt(2.0));
  const double second = std::beta(1.5, 1.25) / (64 * std::sqrt(2.0));
  const double g = (0.421875 * whole + 3 * 0.75 * second) / 3;
  const auto& k = state.parameters;
  for_each("adhesion", p.size(),
           Adhesion{.position = p.position(),
                    .walls = state.walls,
                    .velocity = p.velocity(),
                    .strength = pull_share * k.dt * k.effects[EffectKind::Adhesion] / k.rest_density,
                    .whole = static_cast<float>(whole),
                    .per_g = static_cast<float>(1 / g)});
}

}  // namespace

std::vector<Stage> adhesion_stages() {
  return {stage_of<run>({.name = "adhesion", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
