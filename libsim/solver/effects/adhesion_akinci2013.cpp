/// Adhesion: walls pull at water near them.

#include "libsim/solver/effects/surface_energy.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// What the pull makes of its own work: calibrated by the contact angles of drops of level 0
/// (docs/solver_notes.md).
constexpr float pull_share = 0.75f;

/// A wall is water that stays: tension's pairs act between it and the water before it, where only the latter
/// has a surface. For a plane their sum over the half space behind is
///   m_i dv_i / dt = sigma V_i / h^2 [pull s_i f'(q) - smoothing f''(q) n_i] along the wall's normal,
/// with f the share of poly6 behind it (Walls::behind). It acts where the surface meets the wall, and costs
/// the work sigma: a contact angle of 90 degrees. Works below sigma take a share of it.
///
/// The rest of the work is the printed pull of samples on a wall, A(q) = (-4 q^2 + 6 q - 2)^(1/4) for 1/2 < q
/// < 1, summed over a whole plane at the distance s: g(q) = q int_q^1 A, along the normal. dv = -dt w /
/// (rho_0 h^2) g(s / h) / G with G = int_0^1 q g(q) dq, so that taking a face of water off the wall costs the
/// work w, whatever its particles. Water that is too coarse for tension is not pulled.
struct Adhesion {
  const Vec4* position;
  const float* density;
  const Vec4* normal;
  Walls walls;
  Vec4* velocity;
  float held;      ///< dt sigma / rho_0 times the share of the pairs, m3/s
  float strength;  ///< dt w / rho_0, m3/s
  float whole;     ///< int_1/2^1 A
  float per_g;     ///< 1 / G
  float widest;    ///< support that takes part, m

  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
    const Vec3 n = xyz(normal[i]);
    const float s = skin(density[i]);
    Vec3 v = xyz(velocity[i]);
    for (int k = 0; k < walls.count; ++k) {
      const float q = walls.distance_in_h(k, xyz(at), at.w);
      if (q >= 1) continue;
      const Vec3 away = walls.planes[k].normal;
      const float pull = strength * per_g * sampled(q) + held * tied(q, s, dot(n, away));
      v += -(pull / (at.w * at.w)) * away;
    }
    velocity[i] = with_w(v, 0);
  }

  /// f' = -c (1 - q^2)^4 and f'' = 8 c q (1 - q^2)^3, c = 315 / 256.
  SIM_FN static float tied(float q, float skin, float normal) {
    const float t = 1 - q * q;
    return 1.23046875f * t * t * t * (pull_strength * skin * t + 8 * smoothing_strength * q * normal);
  }

  /// With 4 q - 3 = sin t, A dq = cos^(3/2) t dt / (4 sqrt 2): Simpson's rule over t.
  SIM_FN float sampled(float q) const {
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

using Columns = ColumnView<columns(Column::Position, Column::Density, Column::Normal, Column::Velocity),
                           columns(Column::Velocity)>;

void run(FluidState& state, Columns p) {
  // int_1/2^1 A and G in closed form: with B(x, y) Euler's beta function, A's moments about 3/4 are
  // B(1/2, 5/4) / (4 sqrt 2) and B(3/2, 5/4) / (64 sqrt 2); G = int A q^3 / 3.
  const double whole = std::beta(0.5, 1.25) / (4 * std::sqrt(2.0));
  const double second = std::beta(1.5, 1.25) / (64 * std::sqrt(2.0));
  const double g = (0.421875 * whole + 3 * 0.75 * second) / 3;
  const auto& k = state.parameters;
  const float tension = k.effects[EffectKind::Cohesion], work = k.effects[EffectKind::Adhesion];
  const float share = at_most(work / tension, 1.0f);
  const float rate = k.dt / k.rest_density;
  for_each("adhesion", p.size(),
           Adhesion{.position = p.position(),
                    .density = p.density(),
                    .normal = p.normal(),
                    .walls = state.walls,
                    .velocity = p.velocity(),
                    .held = share * share * tension * rate,
                    .strength = pull_share * at_least(work - tension, 0.0f) * rate,
                    .whole = static_cast<float>(whole),
                    .per_g = static_cast<float>(1 / g),
                    .widest = state.widest_support(EffectOption::CohesionCoarsest)});
}

}  // namespace

std::vector<Stage> adhesion_stages() {
  return {stage_of<run>({.name = "adhesion", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
